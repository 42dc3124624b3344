# Installed files and their Debian packages (docs/install.md), one component per package: main,
# gateway, emulator, python. common/process/installation.cpp uses the same folders.
set(programs lib/active-lab/bin)
set(documents share/doc/active-lab)
set(staged "${CMAKE_BINARY_DIR}/packaging")
# Installing builds nothing: ./lab package has built the programs before.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)

# Only the command active-lab is in PATH. Programs find each other in their common folder.
install(TARGETS lab lab-analyze lab-calibrate lab-doctor lab-export lab-preview lab-program
  lab-reproduce lab-sweep
  lab-run-virtual lab-track lab-twin recorder analyzer projector_ctl robot_bridge sim_svc tracker_svc
  RUNTIME DESTINATION ${programs} COMPONENT main)
if(TARGET dashboard)
  install(TARGETS dashboard RUNTIME DESTINATION ${programs} COMPONENT main)
endif()
install(TARGETS dds_gateway RUNTIME DESTINATION ${programs} COMPONENT gateway)
file(MAKE_DIRECTORY "${staged}")
file(CREATE_LINK ../lib/active-lab/bin/lab "${staged}/active-lab" SYMBOLIC)
install(FILES "${staged}/active-lab" DESTINATION bin COMPONENT main)
if(TARGET firmware)
  install(FILES "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/robot_firmware.hex"
    DESTINATION ${programs} COMPONENT main)
endif()
if(TARGET robot_emulator)
  install(TARGETS robot_emulator RUNTIME DESTINATION ${programs} COMPONENT emulator)
  install(FILES "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/robot_firmware.elf"
    DESTINATION ${programs} COMPONENT emulator)
endif()

if(TARGET lcm_spy_types)
  install(FILES "${CMAKE_BINARY_DIR}/java/active_lab_types.jar" DESTINATION share/java COMPONENT main)
endif()
if(TARGET active_lab_core)
  set(python_package lib/python3/dist-packages/active_lab)
  install(TARGETS active_lab_core LIBRARY DESTINATION ${python_package} COMPONENT python)
  install(FILES ${LAB_PYTHON_SOURCES} DESTINATION ${python_package} COMPONENT python)
  install(DIRECTORY python/examples DESTINATION share/doc/python3-active-lab COMPONENT python)
endif()

# In the texts `./lab` becomes `active-lab`, which users of the packages type.
install(CODE "execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/cmake/packaging/stage_texts.sh\"
  \"${PROJECT_SOURCE_DIR}\" \"${staged}/texts\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT main)
install(DIRECTORY "${staged}/texts/experiments" "${staged}/texts/programs" DESTINATION share/active-lab COMPONENT main)
install(DIRECTORY "${staged}/texts/docs"
  DESTINATION ${documents} COMPONENT main USE_SOURCE_PERMISSIONS)
install(FILES "${staged}/texts/CHANGELOG.md"
  DESTINATION ${documents} COMPONENT main)

install(FILES cmake/packaging/70-active-lab.rules DESTINATION lib/udev/rules.d COMPONENT main)
install(FILES cmake/packaging/active-lab.bash DESTINATION share/bash-completion/completions
  RENAME active-lab COMPONENT main)
install(FILES cmake/packaging/active-lab.desktop DESTINATION share/applications COMPONENT main)
install(FILES cmake/packaging/active-lab.svg DESTINATION share/icons/hicolor/scalable/apps COMPONENT main)
file(READ LICENSE license)
string(REGEX REPLACE "^[^\n]*\n[^\n]*\n[^\n]*\n\n" "" license "${license}")  # title, holders
string(STRIP "${license}" license)
string(REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license "${license}")
configure_file(cmake/packaging/copyright.in "${staged}/copyright" @ONLY)
install(FILES "${staged}/copyright" DESTINATION ${documents} COMPONENT main)
install(FILES "${staged}/copyright" DESTINATION share/doc/active-lab-gateway COMPONENT gateway)
if(TARGET active_lab_core)
  install(FILES "${staged}/copyright" DESTINATION share/doc/python3-active-lab COMPONENT python)
endif()

# lab_man_page(component page program): makes the page from --help of the installed program, which
# prints the commands as users of the package type them.
function(lab_man_page component page program)
  install(CODE "execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/cmake/packaging/man_page.sh\" ${page}
    ${PROJECT_VERSION} \"${PROJECT_SOURCE_DIR}\"
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${programs}/${program}\"
    \"${staged}/${page}.1.gz\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES "${staged}/${page}.1.gz" DESTINATION share/man/man1 COMPONENT ${component})
endfunction()
lab_man_page(main active-lab lab)
foreach(service recorder analyzer projector_ctl robot_bridge sim_svc tracker_svc dashboard)
  if(TARGET ${service})
    lab_man_page(main active-lab-${service} ${service})
  endif()
endforeach()
lab_man_page(gateway active-lab-dds_gateway dds_gateway)
if(TARGET robot_emulator)
  lab_man_page(emulator active-lab-robot_emulator robot_emulator)
  configure_file(cmake/packaging/copyright.emulator.in "${staged}/emulator/copyright" @ONLY)
  install(FILES "${staged}/emulator/copyright" DESTINATION share/doc/active-lab-emulator
    COMPONENT emulator)
endif()

# The packages.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME active-lab)
set(CPACK_PACKAGE_VENDOR "Active Lab")
set(CPACK_PACKAGE_CONTACT "Active Lab contributors <contributors@active-lab.invalid>")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL main gateway)
if(TARGET robot_emulator)
  list(APPEND CPACK_COMPONENTS_ALL emulator)
endif()
if(TARGET active_lab_core)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_MAIN_PACKAGE_NAME active-lab)
# `run` refuses to start without gnuplot for its report.
set(CPACK_DEBIAN_MAIN_PACKAGE_DEPENDS "gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_MAIN_PACKAGE_RECOMMENDS "iproute2, avrdude, liblcm-bin")
set(CPACK_DEBIAN_MAIN_PACKAGE_SUGGESTS
  "active-lab-gateway, active-lab-emulator, ffmpeg, openssh-client, chrony, www-browser")
set(CPACK_COMPONENT_MAIN_DESCRIPTION "instrument for robots driven by light
Drives small robots with light, tracks them, and shows while it runs, with error
bars, whether their motion is the programmed motion. Everything can be
simulated.")
set(same_main "active-lab (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_GATEWAY_PACKAGE_NAME active-lab-gateway)
set(CPACK_DEBIAN_GATEWAY_PACKAGE_DEPENDS "${same_main}")
set(CPACK_COMPONENT_GATEWAY_DESCRIPTION "Active Lab in ROS 2 and on several computers
Bridges a running lab to ROS 2, and joins the parts of one lab on several
computers, over DDS.")
set(CPACK_DEBIAN_EMULATOR_PACKAGE_NAME active-lab-emulator)
set(CPACK_DEBIAN_EMULATOR_PACKAGE_DEPENDS "${same_main}")
set(CPACK_COMPONENT_EMULATOR_DESCRIPTION "simulated chips for Active Lab's robots
Runs the firmware of the robots on simulated ATmega328P chips. This program links
libsimavr and is under the GPL, version 3 or later.")
# The core is for this Python alone.
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-active-lab)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
if(TARGET active_lab_core)
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${Python3_VERSION_MINOR}), \
python3 (<< 3.${next_python}), python3-numpy, python3-pandas")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "active-lab, ffmpeg, python3-matplotlib")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "runs of Active Lab as tables in Python
Opens runs as numpy and pandas tables, evaluates the light anywhere, and lets a
program take part in a running lab, live or in virtual time.")
include(CPack)
