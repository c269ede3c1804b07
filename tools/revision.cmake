# SPDX-License-Identifier: GPL-3.0-or-later
# Writes version.c with the revision of the tree as it is now; run at each build by CMakeLists.txt.
# Without git, or outside a repository, the revision is empty. `git describe --dirty` would lock the
# index, and a commit may be under way; so changes are asked for apart.
set(HAFT_REVISION "")
if(GIT_EXECUTABLE)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --abbrev=12
                  WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE HAFT_REVISION
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${GIT_EXECUTABLE} --no-optional-locks status --porcelain -uno
                  WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    string(APPEND HAFT_REVISION "-dirty")
  endif()
endif()
configure_file(${SOURCE_DIR}/src/base/version.c.in ${OUTPUT} @ONLY)
