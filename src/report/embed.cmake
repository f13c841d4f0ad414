# The browser's side of a report, embedded in the library.
include(${PROJECT_SOURCE_DIR}/cmake/embed.cmake)
pcor_embed(pcor_offline ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp pcor::internal::report
  style report/report.css
  script report/data.js report/pen.js report/axes.js report/charts.js report/dots.js report/quantiles.js
         report/strip.js report/track.js report/panels.js report/what_if_fit.js
         report/what_if.js report/report.js)
