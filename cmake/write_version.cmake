cmake_minimum_required(VERSION 3.25)
# Writes FILE with the version as `git describe` counts it from the last tag "vX.Y.Z", such as
# 0.1.0-12-g1a2b3c4d5, with "-dirty" for a changed work tree. Without a tag, VERSION stands for it
# and the count is left out; without a repository, VERSION is all.
set(text ${VERSION})
find_package(Git QUIET)
if(Git_FOUND AND EXISTS ${SOURCE_DIR}/.git)
  execute_process(
    COMMAND ${GIT_EXECUTABLE} describe --tags --match "v[0-9]*" --always --dirty --abbrev=9
    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE described RESULT_VARIABLE status ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(status EQUAL 0 AND described MATCHES "^v(.*)$")
    set(text ${CMAKE_MATCH_1})
  elseif(status EQUAL 0)
    set(text ${VERSION}-g${described})
  endif()
endif()
file(CONFIGURE OUTPUT ${FILE} CONTENT "#define ORB360_VERSION \"@text@\"\n" @ONLY)
