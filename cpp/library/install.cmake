# The library, its one header, and what find_package(wct) reads. The Python package has none of these.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS wct EXPORT wct ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/include/wct/well_center.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/wct)

set(WCT_CONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/wct)
install(EXPORT wct NAMESPACE wct:: FILE wctTargets.cmake DESTINATION ${WCT_CONFIG_DIR})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/wctConfig.cmake.in wctConfig.cmake
                              INSTALL_DESTINATION ${WCT_CONFIG_DIR})
write_basic_package_version_file(wctConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/wctConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/wctConfigVersion.cmake
        DESTINATION ${WCT_CONFIG_DIR})
