// SPDX-License-Identifier: GPL-2.0-or-later
// An engine that works on some bodies.
#pragma once

#include <core/Engine.hpp>

namespace yade {

class PartialEngine : public Engine {
public:
    vector<int> ids;

    PartialEngine() {}
    ANCF_PACKAGED(PartialEngine)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(PartialEngine)
