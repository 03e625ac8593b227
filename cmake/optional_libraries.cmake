# Libraries that can be left out. Where one is missing, the message names its package.
if(ORB360_WITH_LIBAV)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(LIBAV IMPORTED_TARGET libavformat libavcodec libavutil)
  if(NOT LIBAV_FOUND)
    message(FATAL_ERROR "libav is missing: install libavformat-dev, or configure with "
                        "-DORB360_WITH_LIBAV=OFF to do without the positions in videos")
  endif()
endif()
if(ORB360_WITH_PROJ)
  find_package(PROJ CONFIG QUIET)
  if(NOT PROJ_FOUND OR PROJ_VERSION VERSION_LESS 8)
    message(FATAL_ERROR "PROJ 8 or later is missing: install libproj-dev, or configure with "
                        "-DORB360_WITH_PROJ=OFF to do without places on Earth")
  endif()
endif()
if(ORB360_WITH_LIBWEBSOCKETS)
  pkg_check_modules(LIBWEBSOCKETS IMPORTED_TARGET libwebsockets>=4.1)
  if(NOT LIBWEBSOCKETS_FOUND)
    message(FATAL_ERROR "libwebsockets is missing: install libwebsockets-dev, or configure with "
                        "-DORB360_WITH_LIBWEBSOCKETS=OFF to do without orb360 view")
  endif()
endif()
