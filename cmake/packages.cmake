# CPack makes three Debian packages. `thunderhead` is the server with its page and units. The others are
# `thunderhead-desktop` and `python3-thunderhead`. `./dev package` runs CPack in the release build for `thunderhead` and
# `python3-thunderhead`, and in the desktop build for `thunderhead-desktop`.
set(CPACK_GENERATOR DEB)
set(CPACK_SET_DESTDIR ON)  # needed for /etc
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "The Thunderhead project")
set(CPACK_PACKAGE_HOMEPAGE_URL "")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_OUTPUT_FILE_PREFIX ${CMAKE_SOURCE_DIR}/build/packages)
set(CPACK_COMPONENTS_ALL "")
include(notices)

if(THUNDERHEAD_SERVER AND THUNDERHEAD_SERVICE)
  set(packaging ${CMAKE_BINARY_DIR}/packaging)
  # In a package the program is installed in the folder of system programs, so the units get this path.
  foreach(unit thunderhead.service thunderhead-watch@.service)
    file(READ ${CMAKE_SOURCE_DIR}/deploy/systemd/${unit} text)
    string(REPLACE "/opt/thunderhead/bin/" "/usr/bin/" text "${text}")
    string(REPLACE "/opt/thunderhead/share/doc/" "/usr/share/doc/thunderhead/" text "${text}")
    file(CONFIGURE OUTPUT ${packaging}/${unit} CONTENT "${text}" @ONLY)
  endforeach()
  install(TARGETS thunderhead thunderhead-reader thunderhead-vdb-reader RUNTIME DESTINATION bin COMPONENT server)
  install(TARGETS thunderhead-vdb-writer LIBRARY DESTINATION lib/thunderhead COMPONENT server)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/client-web/dist/ DESTINATION share/thunderhead/page COMPONENT server PATTERN ".built" EXCLUDE)
  install(FILES ${CMAKE_SOURCE_DIR}/samples/supercell-500m.nc DESTINATION share/thunderhead/samples COMPONENT server)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/deploy/views DESTINATION share/thunderhead COMPONENT server)
  install(FILES ${packaging}/thunderhead.service ${packaging}/thunderhead-watch@.service
    DESTINATION lib/systemd/system COMPONENT server)
  install(FILES ${CMAKE_SOURCE_DIR}/deploy/systemd/thunderhead.sysusers DESTINATION lib/sysusers.d RENAME thunderhead.conf
    COMPONENT server)
  install(FILES ${CMAKE_SOURCE_DIR}/deploy/debian/serve.conf DESTINATION /etc/thunderhead COMPONENT server)
  install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION share/doc/thunderhead RENAME copyright COMPONENT server)
  install(FILES ${CMAKE_SOURCE_DIR}/docs/operating.md DESTINATION share/doc/thunderhead COMPONENT server)
  thunderhead_third_party_notices(${packaging}/third-party-notices.txt
    libboost1.74-dev libcli11-dev libglm-dev nlohmann-json3-dev)
  install(FILES ${packaging}/third-party-notices.txt DESTINATION share/doc/thunderhead COMPONENT server)
  set(CPACK_DEBIAN_SERVER_PACKAGE_NAME thunderhead)
  set(CPACK_COMPONENT_SERVER_DESCRIPTION "Server that draws storms of weather models as they would look in the sky")
  # These are the libraries that the server loads by name, the fonts of its products, and the program that creates its
  # user.
  set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS
    "ca-certificates, fontconfig, fonts-dejavu-core, libegl1, libegl-mesa0, libgdal32, libgl1-mesa-dri, libopengl0, systemd | systemd-standalone-sysusers")
  # These packages contain the data of coasts and borders.
  set(CPACK_DEBIAN_SERVER_PACKAGE_RECOMMENDS "gmt-gshhg-high, gmt-gshhg-low")
  set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA
    ${CMAKE_SOURCE_DIR}/deploy/debian/postinst ${CMAKE_SOURCE_DIR}/deploy/debian/prerm ${CMAKE_SOURCE_DIR}/deploy/debian/conffiles)

  # ./dev package builds these files: the Python client's sources, with the messages that protoc generates.
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/build/python/thunderhead DESTINATION lib/python3/dist-packages COMPONENT python
    OPTIONAL PATTERN "__pycache__" EXCLUDE)
  install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION share/doc/python3-thunderhead RENAME copyright COMPONENT python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-thunderhead)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python client of a Thunderhead server")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-grpcio, python3-numpy, python3-pil, python3-protobuf")
  list(APPEND CPACK_COMPONENTS_ALL server python)
endif()

if(THUNDERHEAD_DESKTOP)
  install(TARGETS thunderhead-desktop RUNTIME DESTINATION bin COMPONENT desktop)
  install(FILES ${CMAKE_SOURCE_DIR}/deploy/debian/thunderhead-desktop.desktop DESTINATION share/applications COMPONENT desktop)
  install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION share/doc/thunderhead-desktop RENAME copyright COMPONENT desktop)
  thunderhead_third_party_notices(${CMAKE_BINARY_DIR}/packaging/third-party-notices.txt libcli11-dev libimgui-dev)
  install(FILES ${CMAKE_BINARY_DIR}/packaging/third-party-notices.txt DESTINATION share/doc/thunderhead-desktop COMPONENT desktop)
  set(CPACK_DEBIAN_DESKTOP_PACKAGE_NAME thunderhead-desktop)
  set(CPACK_COMPONENT_DESKTOP_DESCRIPTION "Native window to a Thunderhead server")
  set(CPACK_DEBIAN_DESKTOP_PACKAGE_DEPENDS "fonts-dejavu-core, libgl1, libgl1-mesa-dri")
  list(APPEND CPACK_COMPONENTS_ALL desktop)
endif()
include(CPack)
