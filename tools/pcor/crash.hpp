#pragma once

namespace pcor::tool {

/// Has a crash on a damaged flight, as in the HDF5 library, and one from which that never comes back, end
/// like other errors: with a line that names the file, exit status 1, and nothing unfinished left behind. A
/// crash without a flight in hand stays what it is.
void explain_crashes();

}  // namespace pcor::tool
