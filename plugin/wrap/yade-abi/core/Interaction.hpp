// SPDX-License-Identifier: GPL-2.0-or-later
// A pair of bodies that touch, or may.
#pragma once

#include <core/Body.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>

namespace yade {

class IGeomFunctor;
class IPhysFunctor;
class LawFunctor;

class Interaction : public Serializable {
public:
    bool isActive;
    struct {
        bool geomExists;
        shared_ptr<IGeomFunctor> geom;
        shared_ptr<IPhysFunctor> phys;
        shared_ptr<LawFunctor> constLaw;
    } functorCache;
    Body::id_t id1;
    Body::id_t id2;
    long iterMadeReal;
    long iterLastSeen;
    shared_ptr<IGeom> geom;
    shared_ptr<IPhys> phys;
    Vector3i cellDist;
    int linIx;
    long iterBorn;

    Interaction();
    Interaction(Body::id_t first, Body::id_t second);
    const Body::id_t& getId1() const { return id1; }
    const Body::id_t& getId2() const { return id2; }
    bool isReal() const { return geom && phys; }
    bool isFresh(Scene*);
    void reset();
    void swapOrder();
    py::dict pyDictCustom() const override;
    ANCF_PACKAGED(Interaction)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Interaction)
