#include "numerics/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <future>
#include <system_error>
#include <thread>
#include <vector>

namespace pcor::internal {

void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next = 0;
  const auto work_on = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        next = count;
        throw;
      }
    }
  };
  std::vector<std::future<void>> parts;
  parts.push_back(std::async(std::launch::deferred, work_on));  // this thread, when it waits
  try {
    for (std::size_t k = 1; k < std::min(threads, count); ++k)
      parts.push_back(std::async(std::launch::async, work_on));
  } catch (const std::system_error&) {
    // The system has no more threads to give; those that there are do it all.
  }
  std::exception_ptr thrown;
  for (std::future<void>& part : parts) {
    try {
      part.get();
    } catch (...) {
      if (!thrown) thrown = std::current_exception();
    }
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace pcor::internal
