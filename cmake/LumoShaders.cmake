# lumo_shaders(NAME [ROOT folder] FILES stage files...): the static library lumo_NAME, alias lumo::NAME, of shader
# programs and the C++ types that they are used through. Also for projects that find_package(lumo).
#
# Stage files are ROOT/FOLDER/STEM.comp, or ROOT/FOLDER/STEM.vert with .geom or .frag or both; all files of one stem
# are one program. Its type is lumo::shaders::FOLDER::STEM, in "shaders/FOLDER/STEM.hpp". ROOT is the current source
# folder unless given, and relative to that; files are relative to ROOT or absolute. #include "..." is searched in ROOT, then in lumo's
# shaders/. A FOLDER of another library's is to be avoided: the headers would have the same name.
#
# What tests need, for example, lies beside them:
#   file(GLOB_RECURSE files CONFIGURE_DEPENDS shaders/*.comp)
#   lumo_shaders(test_shaders ROOT ${CMAKE_CURRENT_SOURCE_DIR}/shaders FILES ${files})
# for shaders/test_rhi/fill.comp, the type lumo::shaders::test_rhi::fill.
function(lumo_shaders name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "ROOT" "FILES")
    set(root ${arg_ROOT})
    if(NOT root)
        set(root ${CMAKE_CURRENT_SOURCE_DIR})
    endif()
    cmake_path(ABSOLUTE_PATH root NORMALIZE)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}_generated)

    set(programs)
    foreach(file IN LISTS arg_FILES)
        cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${root} NORMALIZE)
        cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${root} OUTPUT_VARIABLE program)
        cmake_path(REMOVE_EXTENSION program LAST_ONLY)
        list(APPEND programs ${program})
        list(APPEND files_of_${program} ${file})
    endforeach()
    list(REMOVE_DUPLICATES programs)

    set(sources)
    foreach(program IN LISTS programs)
        set(base ${output}/shaders/${program})
        add_custom_command(
            OUTPUT ${base}.cpp ${base}.hpp
            COMMAND lumo::shaderc --root ${root} -I ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../shaders -o ${output}
                    --depfile ${base}.d ${files_of_${program}}
            DEPENDS lumo::shaderc ${files_of_${program}}
            DEPFILE ${base}.d
            COMMENT "Shader program ${program}"
            VERBATIM)
        list(APPEND sources ${base}.cpp)
    endforeach()

    if(sources)
        add_library(lumo_${name} STATIC ${sources})
        target_link_libraries(lumo_${name} PUBLIC lumo::rhi_base glm::glm)
        target_compile_features(lumo_${name} PUBLIC cxx_std_20)
        target_include_directories(lumo_${name} PUBLIC $<BUILD_INTERFACE:${output}>
                                                       $<INSTALL_INTERFACE:include/lumo>)
        # Else a vec3 would silently become a vec2, and a push constant of the wrong type would compile.
        target_compile_definitions(lumo_${name} PUBLIC GLM_FORCE_EXPLICIT_CTOR)
        set_target_properties(lumo_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
                                                      CXX_CLANG_TIDY "")
        if(COMMAND lumo_warnings)
            lumo_warnings(lumo_${name})
        endif()
    else()
        add_library(lumo_${name} INTERFACE)
        target_link_libraries(lumo_${name} INTERFACE lumo::rhi_base glm::glm)
    endif()
    add_library(lumo::${name} ALIAS lumo_${name})
endfunction()
