// SPDX-License-Identifier: GPL-2.0-or-later
// Axis-aligned box.
#pragma once

#include <core/Bound.hpp>

namespace yade {

class Aabb : public Bound {
public:
    Aabb();
    ANCF_PACKAGED(Aabb)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Aabb)
