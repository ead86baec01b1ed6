// SPDX-License-Identifier: GPL-2.0-or-later
// The abstract functors of the contact loop. To be derived from; dispatchers are used from Python.
#pragma once

#include <core/Aabb.hpp>
#include <core/Dispatcher.hpp>
#include <core/Functor.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>
#include <core/Interaction.hpp>
#include <core/Scene.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

namespace yade {

class BoundFunctor
    : public Functor1D<Shape, void,
                       TYPELIST_4(const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&, const Body*)> {
public:
    BoundFunctor() noexcept {}
    ANCF_PACKAGED(BoundFunctor)
};

class IGeomFunctor
    : public Functor2D<Shape, Shape, bool,
                       TYPELIST_7(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&,
                                  const Vector3r&, const bool&, const shared_ptr<Interaction>&)> {
public:
    IGeomFunctor() noexcept {}
    virtual void preStep();
    ANCF_PACKAGED(IGeomFunctor)
};

class IPhysFunctor : public Functor2D<Material, Material, void,
                                      TYPELIST_3(const shared_ptr<Material>&, const shared_ptr<Material>&,
                                                 const shared_ptr<Interaction>&)> {
public:
    IPhysFunctor() noexcept {}
    ANCF_PACKAGED(IPhysFunctor)
};

class LawFunctor
    : public Functor2D<IGeom, IPhys, bool, TYPELIST_3(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*)> {
public:
    LawFunctor() noexcept {}
    void addForce(Body::id_t id, const Vector3r& f, Scene* where) { where->forces.addForce(id, f); }
    void addTorque(Body::id_t id, const Vector3r& t, Scene* where) { where->forces.addTorque(id, t); }
    // force acts on the first body, its opposite on the second
    void applyForceAtContactPoint(const Vector3r& force, const Vector3r& contactPoint, Body::id_t id1,
                                  const Vector3r& pos1, Body::id_t id2, const Vector3r& pos2);
    ANCF_PACKAGED(LawFunctor)
};

// Of a dispatcher only the list of functors is read, and nobody makes one here.
template <class FunctorType> class DispatchTable : public Dispatcher {
    vector<shared_ptr<FunctorType>> callBacks; // by class, not to be touched, nor what else is told of them
    vector<int> callBacksInfo;

public:
    DispatchTable() = delete;
};

class BoundDispatcher : public DispatchTable<BoundFunctor> {
public:
    vector<shared_ptr<BoundFunctor>> functors;
};

class IGeomDispatcher : public DispatchTable<IGeomFunctor> {
    bool alreadyWarnedNoCollider;

public:
    vector<shared_ptr<IGeomFunctor>> functors;
};

class IPhysDispatcher : public DispatchTable<IPhysFunctor> {
public:
    vector<shared_ptr<IPhysFunctor>> functors;
};

class LawDispatcher : public DispatchTable<LawFunctor> {
public:
    vector<shared_ptr<LawFunctor>> functors;
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(BoundFunctor)
ANCF_PACKAGED_REGISTERED(IGeomFunctor)
ANCF_PACKAGED_REGISTERED(IPhysFunctor)
ANCF_PACKAGED_REGISTERED(LawFunctor)
