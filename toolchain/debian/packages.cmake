# Three Debian packages from one build: `cpack -G DEB --config build/release/CPackConfig.cmake -B build/packages`. docs/installing.md is for their users.
# Two for arm64, which has no simulator: toolchain/aarch64/make_packages.sh.
#
# lanternfish-common: the files both programs read (arm, limits, CAN map). lanternfish: the simulator. lanternfishd: the vehicle's program, with its units,
# udev rule and configuration; it needs no simulator.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "Lanternfish developers")
set(CPACK_PACKAGE_CONTACT "Lanternfish developers <lanternfish@invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL lanternfish-common)
if(TARGET lanternfish)
  list(APPEND CPACK_COMPONENTS_ALL lanternfish)
endif()
if(TARGET lanternfishd)
  list(APPEND CPACK_COMPONENTS_ALL lanternfishd)
endif()
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
else()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_LANTERNFISH-COMMON_PACKAGE_NAME lanternfish-common)
set(CPACK_DEBIAN_LANTERNFISH-COMMON_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_LANTERNFISH-COMMON_DESCRIPTION "arm, limits and CAN map of an underwater robot that works on panels
 The files that the simulator and the vehicle's control program both read.")
set(CPACK_DEBIAN_LANTERNFISH_PACKAGE_NAME lanternfish)
set(CPACK_DEBIAN_LANTERNFISH_PACKAGE_DEPENDS "lanternfish-common (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_LANTERNFISH_DESCRIPTION "simulator of an underwater robot that works on panels
 Flies the robot's own control core against simulated physics, drives and camera:
 missions, campaigns, and each stage of the perception on its own.
 Built for processors with AVX2.")
set(CPACK_DEBIAN_LANTERNFISHD_PACKAGE_NAME lanternfishd)
set(CPACK_COMPONENT_LANTERNFISHD_DESCRIPTION "control program of an underwater robot that works on panels
 Runs the control core against CANopen drives on SocketCAN and a V4L2 camera, in
 real time. Installing it starts nothing: set /etc/lanternfish/vehicle.yaml first.")
# iproute2 moves the CAN interface into the service's network namespace.
set(CPACK_DEBIAN_LANTERNFISHD_PACKAGE_DEPENDS "lanternfish-common (= ${PROJECT_VERSION}), passwd, iproute2")
set(CPACK_DEBIAN_LANTERNFISHD_PACKAGE_SUGGESTS "can-utils")
set(CPACK_DEBIAN_LANTERNFISHD_PACKAGE_CONTROL_EXTRA
  ${CMAKE_CURRENT_LIST_DIR}/postinst ${CMAKE_CURRENT_LIST_DIR}/prerm ${CMAKE_CURRENT_LIST_DIR}/postrm ${CMAKE_CURRENT_LIST_DIR}/conffiles)

# What Debian expects in /usr/share: manual pages and the changelog, packed so that two builds are the same.
find_program(GZIP gzip REQUIRED)
function(install_packed source destination name component)
  set(packed ${CMAKE_BINARY_DIR}/share/${component}/${name}.gz)
  cmake_path(GET packed PARENT_PATH folder)
  add_custom_command(OUTPUT ${packed} COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND sh -c "${GZIP} -9nc '${source}' > '${packed}'" DEPENDS ${source} VERBATIM)
  string(MAKE_C_IDENTIFIER packed_${component}_${name} target)
  add_custom_target(${target} ALL DEPENDS ${packed})
  install(FILES ${packed} DESTINATION ${destination} COMPONENT ${component})
endfunction()
foreach(component ${CPACK_COMPONENTS_ALL})
  install_packed(${CMAKE_SOURCE_DIR}/CHANGELOG.md share/doc/${component} changelog ${component})
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION share/doc/${component} COMPONENT ${component})
endforeach()
# The programs print all of these themselves: tests/unit/app/help_test.cpp and tests/unit/vehicle/command_test.cpp hold them.
function(install_completion program)
  set(scripts ${CMAKE_SOURCE_DIR}/toolchain/completion)
  install(FILES ${scripts}/${program}.bash DESTINATION share/bash-completion/completions RENAME ${program} COMPONENT ${program})
  install(FILES ${scripts}/_${program} DESTINATION share/zsh/vendor-completions COMPONENT ${program})
endfunction()
if(TARGET lanternfish)
  install_completion(lanternfish)
  install_packed(${CMAKE_SOURCE_DIR}/docs/man/lanternfish.1 share/man/man1 lanternfish.1 lanternfish)
  install_packed(${CMAKE_SOURCE_DIR}/docs/man/lanternfish-scenario.5 share/man/man5 lanternfish-scenario.5 lanternfish)
  install(FILES ${CMAKE_SOURCE_DIR}/docs/scenarios.md ${CMAKE_SOURCE_DIR}/docs/commands.md ${CMAKE_SOURCE_DIR}/docs/your-arm.md
    ${CMAKE_SOURCE_DIR}/docs/your-panel.md DESTINATION share/doc/lanternfish COMPONENT lanternfish)
endif()
if(TARGET lanternfishd)
  install_completion(lanternfishd)
  install_packed(${CMAKE_SOURCE_DIR}/docs/man/lanternfishd.8 share/man/man8 lanternfishd.8 lanternfishd)
  install_packed(${CMAKE_SOURCE_DIR}/docs/man/lanternfish-vehicle.5 share/man/man5 lanternfish-vehicle.5 lanternfishd)
  install_packed(${CMAKE_SOURCE_DIR}/docs/man/vehicle.yaml.5 share/man/man5 vehicle.yaml.5 lanternfishd)
  install(FILES ${CMAKE_SOURCE_DIR}/shared/vehicle/vehicle.yaml DESTINATION /etc/lanternfish COMPONENT lanternfishd)
  # The pages that the configuration and the units point to.
  foreach(page operating installing security safety vehicle canopen mission processors your-arm your-panel)
    install(FILES ${CMAKE_SOURCE_DIR}/docs/${page}.md DESTINATION share/doc/lanternfishd COMPONENT lanternfishd)
  endforeach()
endif()

include(CPack)
