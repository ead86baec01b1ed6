// SPDX-License-Identifier: GPL-2.0-or-later
// What a body is made of.
#pragma once

#include <core/State.hpp>

namespace yade {

class Scene;

class Material : public Serializable, public Indexable {
public:
    int id;
    string label;
    Real density;

    Material() : id(-1), density(1000) {}

    // The order of declaration is that of the vtable.
    virtual shared_ptr<State> newAssocState() const;
    virtual bool stateTypeOk(State*) const;

    static const shared_ptr<Material> byId(int id, Scene* scene = nullptr);
    static const shared_ptr<Material> byLabel(const std::string& label, Scene* scene = nullptr);
    static int byLabelIndex(const std::string& label, Scene* scene = nullptr);
    ANCF_PACKAGED(Material)
    ANCF_PACKAGED_INDEX_ROOT
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Material)
