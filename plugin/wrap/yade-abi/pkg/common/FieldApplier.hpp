// SPDX-License-Identifier: GPL-2.0-or-later
// Engine that applies a field such as gravity.
#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

class FieldApplier : public GlobalEngine {
public:
    int fieldWorkIx;

    FieldApplier() : fieldWorkIx(-1) {}
    void action() override;
    ANCF_PACKAGED(FieldApplier)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(FieldApplier)
