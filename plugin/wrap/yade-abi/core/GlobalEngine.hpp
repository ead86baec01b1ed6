// SPDX-License-Identifier: GPL-2.0-or-later
// An engine that works on the whole scene.
#pragma once

#include <core/Engine.hpp>

namespace yade {

class GlobalEngine : public Engine {
public:
    GlobalEngine() {}
    ANCF_PACKAGED(GlobalEngine)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(GlobalEngine)
