# lumo_library(NAME SOURCES... LINK PUBLIC|PRIVATE libs...): the library target lumo_NAME, alias lumo::NAME, with
# the project's warnings. Headers are included by their path from the repository's root.
function(lumo_warnings target)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Werror)
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
        target_compile_options(${target} PRIVATE -Wno-restrict)  # false for "text" + std::string (GCC bug 105651)
    endif()
    if(LUMO_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                 -fno-omit-frame-pointer)
        target_link_options(${target} PRIVATE -fsanitize=address,undefined)
    endif()
endfunction()

function(lumo_library name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
    add_library(lumo_${name} STATIC ${arg_SOURCES})
    add_library(lumo::${name} ALIAS lumo_${name})
    target_include_directories(lumo_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                   $<INSTALL_INTERFACE:include/lumo>)
    target_compile_features(lumo_${name} PUBLIC cxx_std_20)
    target_link_libraries(lumo_${name} ${arg_LINK})
    set_target_properties(lumo_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
    lumo_warnings(lumo_${name})
endfunction()
