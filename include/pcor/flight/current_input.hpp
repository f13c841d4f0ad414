#pragma once

namespace pcor {

/// The path of the flight that is being read at this moment, null where none is.
///
/// The HDF5 library may crash on a damaged file, or never come back from one. A program asks this in its
/// handlers of signals, to say which file it was; nothing is allocated.
const char* current_input_path() noexcept;

/// Whether another flight was read before it. A damaged file may spoil the memory of the HDF5 library without
/// a word, so that the library crashes on the next one.
bool had_previous_input() noexcept;

/// Processor time, s, after which a library that reads a flight never comes back: a hundred times what one
/// takes to open, or to read some thousand records.
inline constexpr int max_seconds_per_input = 4;

/// How much processor time the thread that reads has spent since it last began to read, s: the list of the
/// variables, or some thousand records of one. 0 where no flight is read.
double current_input_seconds() noexcept;

/// Time, s, without any work of the processor, after which nothing more comes: a file may link to a pipe,
/// which never answers.
inline constexpr int max_seconds_of_waiting = 30;

/// How long the thread that reads has waited since it last began to read, s, without any work of the
/// processor. 0 where no flight is read, and where it works.
double seconds_of_waiting() noexcept;

}  // namespace pcor
