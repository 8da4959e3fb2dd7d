# What `cmake --install` puts into a prefix: the programs, the libraries with their headers, and in lib/lumo all that
# find_package(lumo) needs. The tree can be moved.
include(CMakePackageConfigHelpers)

set(libraries rhi_base rhi backends window scene gpu_scene shaders techniques reference)
list(TRANSFORM libraries PREPEND lumo_)
set_target_properties(lumo_shaderc PROPERTIES EXPORT_NAME shaderc)
install(TARGETS ${libraries} lumo_shaderc EXPORT lumo_targets ARCHIVE DESTINATION lib RUNTIME DESTINATION bin)
install(TARGETS lumo RUNTIME DESTINATION bin)
if(TARGET lumo_image_oiio)
    install(TARGETS lumo_image_oiio LIBRARY DESTINATION lib/lumo)
endif()

# The interfaces, and not what only the libraries include.
install(DIRECTORY rhi scene techniques reference DESTINATION include/lumo FILES_MATCHING PATTERN "*.hpp"
        PATTERN "rhi/arena.hpp" EXCLUDE PATTERN "rhi/core.hpp" EXCLUDE
        PATTERN "rhi/resource_table.hpp" EXCLUDE PATTERN "rhi/staging.hpp" EXCLUDE PATTERN "rhi/validate.hpp" EXCLUDE
        PATTERN "scene/gltf_*" EXCLUDE PATTERN "scene/image_codec.hpp" EXCLUDE PATTERN "scene/builtin" EXCLUDE
        PATTERN "scene/oiio" EXCLUDE PATTERN "reference/embree.hpp" EXCLUDE
        PATTERN "scene/content_key.hpp" EXCLUDE PATTERN "reference/cache.hpp" EXCLUDE)
install(DIRECTORY backends DESTINATION include/lumo FILES_MATCHING PATTERN "backends/*.hpp"
        PATTERN "backends/gl/*" EXCLUDE PATTERN "backends/vulkan/*" EXCLUDE)
foreach(api gl vulkan)
    install(FILES backends/${api}/adopt.hpp DESTINATION include/lumo/backends/${api})
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/shaders/shaders_generated/shaders DESTINATION include/lumo
        FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY shaders DESTINATION lib/lumo FILES_MATCHING PATTERN "*.glsl")

set(package_folder lib/lumo/cmake)
install(EXPORT lumo_targets NAMESPACE lumo:: DESTINATION ${package_folder})
configure_package_config_file(cmake/lumoConfig.cmake.in ${PROJECT_BINARY_DIR}/lumoConfig.cmake
                              INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lumoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lumoConfig.cmake ${PROJECT_BINARY_DIR}/lumoConfigVersion.cmake
              cmake/LumoShaders.cmake
        DESTINATION ${package_folder})
