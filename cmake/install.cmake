# The libraries and their headers, the programs, the shipped weights, and the package file with which
# find_package(orb360) finds them. Version and SONAME are those of project(): an interface may change
# with the minor version as long as the major one is 0.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/orb360)
foreach(name base nn slam)
  set_target_properties(orb360_${name} PROPERTIES
    EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
endforeach()
install(TARGETS orb360_base orb360_nn orb360_slam EXPORT orb360Targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/orb360 DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT orb360Targets NAMESPACE orb360:: DESTINATION ${package_folder})
configure_package_config_file(cmake/orb360Config.cmake.in orb360Config.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(orb360ConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/orb360Config.cmake
              ${PROJECT_BINARY_DIR}/orb360ConfigVersion.cmake DESTINATION ${package_folder})
install(DIRECTORY weights DESTINATION ${CMAKE_INSTALL_DATADIR}/orb360
        FILES_MATCHING PATTERN "*.h5" PATTERN "README.md")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
