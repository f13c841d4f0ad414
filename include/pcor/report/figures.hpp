#pragma once

#include <pcor/report/report.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace pcor {

/// What figures are for, by which they have their width: a page of paper of 180 mm, a column of 86 mm, or a
/// slide of 1280 dots. Letters have at least 8 points on paper.
enum class FigureUse { page, column, slide };

/// Makes sure, before the work, that figures can be drawn and put into a folder.
/// @throws Error if there is no browser to draw them, or the folder cannot be there.
void require_figures(const std::filesystem::path& folder);

/// Writes every picture of a report into a folder, as SVG and as PNG, on white, with its title, and
/// "captions.txt", which says what each shows. They are the pictures of the page: its own script draws them,
/// in Chromium or another browser of its kind, which is not seen; the environment variable CHROMIUM may name
/// it. The folder is made if it is not there. All pictures appear together or none does; those that the
/// folder's captions name from before go, other files stay.
///
/// @returns the names of the files
/// @throws Error as `report_html` and `require_figures`, or if the browser or
/// the writing fails.
std::vector<std::string> write_figures(const Report& report, const std::filesystem::path& folder,
                                       FigureUse use = FigureUse::page);

}  // namespace pcor
