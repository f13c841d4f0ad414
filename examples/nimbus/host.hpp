#pragma once

#include <cstddef>
#include <string>
#include <vector>

// A stand-in for what a host like NCAR nimbus has in its headers: nothing of nimbus itself.

enum FeedBackType { LOW_RATE_FEEDBACK, HIGH_RATE_FEEDBACK };

/// Which of the two rates is being computed.
extern FeedBackType FeedBack;

/// A derived variable: on which others it depends, and the function that computes it.
struct DERTBL {
  std::string name;
  std::vector<std::string> depends;
  void (*compute)(DERTBL*);
  std::vector<std::size_t> depend_places{};  ///< in the record of the sample
  std::size_t place = 0;
};

/// The value of the dependency number `input` at this sample; NaN where it is missing.
float GetSample(const DERTBL* entry, std::size_t input);
void PutSample(const DERTBL* entry, float value);

/// The value of that name in the defaults file, which keeps names in capitals; null where there is none.
const float* GetDefault(const char* name);
std::vector<std::string> DefaultNames();
