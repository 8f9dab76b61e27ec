# The page of the console. Node comes from a wheel, so a machine needs none of its own; the packages
# come from the lock file. A source distribution carries the built page and skips all this, and so
# does an editable installation: scripts/setup page builds it, npm run dev serves it as it is.

set(PAGE "${CMAKE_CURRENT_SOURCE_DIR}/kompass_console/static")
file(GLOB_RECURSE _page_sources CONFIGURE_DEPENDS
  "${CMAKE_CURRENT_SOURCE_DIR}/web/src/*" "${CMAKE_CURRENT_SOURCE_DIR}/web/public/*")
file(GLOB _page_config CONFIGURE_DEPENDS
  "${CMAKE_CURRENT_SOURCE_DIR}/web/*.json" "${CMAKE_CURRENT_SOURCE_DIR}/web/*.ts"
  "${CMAKE_CURRENT_SOURCE_DIR}/web/*.html" "${CMAKE_CURRENT_SOURCE_DIR}/web/.npmrc")

if(NOT SKBUILD_STATE STREQUAL "editable" AND EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/web/package-lock.json")
  set(_stamp "${CMAKE_CURRENT_BINARY_DIR}/page.stamp")
  add_custom_command(
    OUTPUT "${_stamp}"
    COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.py"
    COMMAND "${CMAKE_COMMAND}" -E touch "${_stamp}"
    DEPENDS ${_page_sources} ${_page_config} "${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.py"
      "${CMAKE_CURRENT_SOURCE_DIR}/cmake/npm.py"
    COMMENT "Building the page of the console"
    VERBATIM)
  add_custom_target(page ALL DEPENDS "${_stamp}")
endif()
