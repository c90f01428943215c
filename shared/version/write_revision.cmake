# Writes OUT from IN with the revision of SOURCE's git tree, "-dirty" where it was edited since. OUT is left alone when nothing has changed.
set(REVISION "unknown")
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} describe --always --dirty WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
  if(result EQUAL 0)
    set(REVISION ${said})
  endif()
endif()
configure_file(${IN} ${OUT} @ONLY)
