# The page of the console. Node comes from a wheel, so a machine needs none of its own; the packages
# come from the lock file. A source distribution carries the built page and skips all this.

set(PAGE "${CMAKE_CURRENT_SOURCE_DIR}/kompass_console/static")
file(GLOB_RECURSE _page_sources CONFIGURE_DEPENDS
  "${CMAKE_CURRENT_SOURCE_DIR}/web/src/*" "${CMAKE_CURRENT_SOURCE_DIR}/web/public/*")
file(GLOB _page_config CONFIGURE_DEPENDS
  "${CMAKE_CURRENT_SOURCE_DIR}/web/*.json" "${CMAKE_CURRENT_SOURCE_DIR}/web/*.ts"
  "${CMAKE_CURRENT_SOURCE_DIR}/web/*.html" "${CMAKE_CURRENT_SOURCE_DIR}/web/.npmrc")

option(KOMPASS_PAGE "Build the page; OFF while working on Python alone" ON)
if(KOMPASS_PAGE AND EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/web/package-lock.json")
  set(_stamp "${CMAKE_CURRENT_BINARY_DIR}/page.stamp")
  add_custom_command(
    OUTPUT "${_stamp}"
    COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.py"
      "${CMAKE_CURRENT_SOURCE_DIR}/web" "${PAGE}"
    COMMAND "${CMAKE_COMMAND}" -E touch "${_stamp}"
    DEPENDS ${_page_sources} ${_page_config} "${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.py"
    COMMENT "Building the page of the console"
    VERBATIM)
  add_custom_target(page ALL DEPENDS "${_stamp}")
endif()
install(DIRECTORY "${PAGE}" DESTINATION kompass_console)
