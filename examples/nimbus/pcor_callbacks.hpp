#pragma once

#include <string>

#include "host.hpp"

/// Sets the correction up, before the first sample and before the order of the table is found. False where it
/// cannot be; `error` says why.
bool pcor_install(std::string* error);

/// Forgets earlier samples: at the start of a flight and after a gap.
void pcor_reset();

// What the table of derived variables holds: names of C, as it knows no templates.
extern "C" {
void spcor(DERTBL* entry);
void spsxc(DERTBL* entry);
void sqcxc(DERTBL* entry);
void smachx(DERTBL* entry);
void satx(DERTBL* entry);
void stasx(DERTBL* entry);
void spcorflag(DERTBL* entry);
}
