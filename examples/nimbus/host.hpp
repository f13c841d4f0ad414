#pragma once

#include <cstddef>
#include <string>
#include <vector>

// Stand-in for the headers of a host such as NCAR nimbus; it contains no code of nimbus.

enum FeedBackType { LOW_RATE_FEEDBACK, HIGH_RATE_FEEDBACK };

/// Rate of the current computation.
extern FeedBackType FeedBack;

/// Derived variable: its dependencies and the function that computes it.
struct DERTBL {
  std::string name;
  std::vector<std::string> depends;
  void (*compute)(DERTBL*);
  std::vector<std::size_t> depend_places{};  ///< index in the record of the sample
  std::size_t place = 0;
};

/// Value of the dependency number `input` at this sample; -32767 if it is missing.
float GetSample(const DERTBL* entry, std::size_t input);
void PutSample(const DERTBL* entry, float value);

/// Value of an entry in the defaults file; nullptr if it is absent. Names in the file are in capitals.
const float* GetDefault(const char* name);
std::vector<std::string> DefaultNames();
