// SPDX-License-Identifier: GPL-2.0-or-later
// A particle.
#pragma once

#include <core/Bound.hpp>
#include <core/Material.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

#include <map>

namespace yade {

class Scene;
class Interaction;

class Body : public Serializable {
public:
    using id_t = int;
    using MapId2IntrT = std::map<id_t, shared_ptr<Interaction>>;

    id_t id;
    mask_t groupMask;
    int flags;
    int subdomain;
    shared_ptr<Material> material;
    shared_ptr<State> state;
    shared_ptr<Shape> shape;
    shared_ptr<Bound> bound;
    MapId2IntrT intrs;
    id_t clumpId;
    long iterBorn;
    Real timeBorn;

    static const id_t ID_NONE;
    static const shared_ptr<Body>& byId(id_t id, Scene* scene = nullptr);
    static const shared_ptr<Body>& byId(id_t id, shared_ptr<Scene> scene);

    Body();
    id_t getId() const { return id; }
    mask_t getGroupMask() const { return groupMask; }
    bool isClump() const;
    bool isClumpMember() const;
    bool isStandalone() const;
    bool isDynamic() const;
    void setDynamic(bool);
    bool isBounded() const;
    void setBounded(bool);
    bool isAspherical() const;
    void setAspherical(bool);
    bool maskOk(int mask) const;
    bool maskCompatible(int mask) const;
    unsigned coordNumber() const;

    virtual void userForcedDisplacementRedrawHook();
    py::dict pyDictCustom() const override;
    ANCF_PACKAGED(Body)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Body)
