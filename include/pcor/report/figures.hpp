#pragma once

#include <pcor/report/report.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace pcor {

/// Medium of figures, which sets their width: a page of paper, 180 mm; a column, 86 mm; or a slide, 1280
/// pixels. Text has at least 8 points on paper.
enum class FigureUse { page, column, slide };

/// Checks, before the computation, that figures can be drawn and written to a directory.
/// @throws Error if there is no browser to draw them, or the directory cannot be created.
void require_figures(const std::filesystem::path& folder);

/// Writes every figure of a report to a directory, as SVG and as PNG, on white, with its title, and
/// "captions.txt" with the captions. Figures are drawn by the script of the page in headless Chromium or a
/// compatible browser; the environment variable CHROMIUM may name it. The directory is created if needed. All
/// figures appear together or not at all; older ones listed in the directory's captions are removed, other
/// files remain.
///
/// @returns names of the files
/// @throws Error as `report_html` and `require_figures`, or if the browser or the writing fails.
std::vector<std::string> write_figures(const Report& report, const std::filesystem::path& folder,
                                       FigureUse use = FigureUse::page);

}  // namespace pcor
