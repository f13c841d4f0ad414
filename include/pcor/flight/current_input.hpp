#pragma once

namespace pcor {

/// Path of the flight currently being read; nullptr if no flight is being read.
///
/// The HDF5 library may crash or not return on a damaged file. For signal handlers, to report the file; does
/// not allocate.
const char* current_input_path() noexcept;

/// True if another flight was read before. A damaged file may silently corrupt the memory of the HDF5
/// library, which then crashes on the next file.
bool had_previous_input() noexcept;

/// Processor time, s, after which reading counts as hung: a hundred times the usual time for opening a file
/// or reading a few thousand records.
inline constexpr int max_seconds_per_input = 4;

/// Processor time of the reading thread since its last read began, s: a read is the list of variables, or a
/// few thousand records of a variable. 0 if no flight is being read.
double current_input_seconds() noexcept;

/// Maximum waiting time without processor activity, s: a file may link to a pipe, which never responds.
inline constexpr int max_seconds_of_waiting = 30;

/// Waiting time of the reading thread, s: since its last read began or since the last call that found that
/// the thread had used processor time. 0 if no flight is being read. To be called regularly.
double seconds_of_waiting() noexcept;

}  // namespace pcor
