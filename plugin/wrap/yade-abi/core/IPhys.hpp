// SPDX-License-Identifier: GPL-2.0-or-later
// Forces and stiffness of a contact.
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class IPhys : public Serializable, public Indexable {
public:
    IPhys() {}
    ANCF_PACKAGED(IPhys)
    ANCF_PACKAGED_INDEX_ROOT
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(IPhys)
