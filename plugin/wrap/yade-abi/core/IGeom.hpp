// SPDX-License-Identifier: GPL-2.0-or-later
// Geometry of a contact.
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class IGeom : public Serializable, public Indexable {
public:
    IGeom() {}
    ANCF_PACKAGED(IGeom)
    ANCF_PACKAGED_INDEX_ROOT
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(IGeom)
