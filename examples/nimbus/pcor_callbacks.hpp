#pragma once

#include <string>

#include "host.hpp"

/// Sets the correction up, before the first sample and before the order of the table is found. Returns false
/// on failure; `error` states the reason.
bool pcor_install(std::string* error);

/// Discards earlier samples: call it at the start of a flight and after a gap.
void pcor_reset();

// Names for the table of derived variables: plain C functions, because the table has no templates.
extern "C" {
void spcor(DERTBL* entry);
void spsxc(DERTBL* entry);
void sqcxc(DERTBL* entry);
void smachx(DERTBL* entry);
void satx(DERTBL* entry);
void stasx(DERTBL* entry);
void spcorflag(DERTBL* entry);
}
