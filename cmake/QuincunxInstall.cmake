# Shaders and data beside the programs, and a CMake package for those who build on the library:
#   find_package(Quincunx REQUIRED)
#   target_link_libraries(mine PRIVATE Quincunx::common)      or one room of it: Quincunx::math
include(CMakePackageConfigHelpers)

install(DIRECTORY shaders data web DESTINATION ${CMAKE_INSTALL_DATADIR}/quincunx)
# What the pages of the atlas quote of them.
install(DIRECTORY labs DESTINATION ${CMAKE_INSTALL_DATADIR}/quincunx FILES_MATCHING PATTERN "README.md")

# Libraries of `folder` and below, which is what those who link to one of them need at link time.
function(quincunx_libraries_below folder out)
  set(found "")
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type MATCHES "^(STATIC|INTERFACE)_LIBRARY$")
      list(APPEND found ${target})
    endif()
  endforeach()
  get_property(children DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(child ${children})
    quincunx_libraries_below(${child} below)
    list(APPEND found ${below})
  endforeach()
  set(${out} "${found}" PARENT_SCOPE)
endfunction()

quincunx_libraries_below("${PROJECT_SOURCE_DIR}/common" libraries)
list(APPEND libraries quincunx_flags)
foreach(library ${libraries})
  string(REGEX REPLACE "^quincunx_" "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
endforeach()
install(TARGETS ${libraries} EXPORT QuincunxTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/quincunx)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Quincunx)
install(EXPORT QuincunxTargets NAMESPACE Quincunx:: DESTINATION ${package_folder})
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/QuincunxConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/QuincunxConfig.cmake" INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/QuincunxConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/QuincunxConfig.cmake" "${PROJECT_BINARY_DIR}/QuincunxConfigVersion.cmake"
  DESTINATION ${package_folder})
