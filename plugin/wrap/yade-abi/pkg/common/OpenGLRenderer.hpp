// SPDX-License-Identifier: GPL-2.0-or-later
// The 3D view: finds for each body how it is drawn. The first part of it; nobody makes one here.
#pragma once

#include <core/Dispatching.hpp>
#include <core/Scene.hpp>
#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class GlBoundFunctor;
class GlIGeomFunctor;
class GlIPhysFunctor;

// Draws what belongs to no body, after all bodies.
class GlExtraDrawer : public Serializable {
public:
    Scene* scene = nullptr; // that is drawn
    GlExtraDrawer() noexcept {}
    virtual void render();
    bool dead = false;
    ANCF_PACKAGED(GlExtraDrawer)
};

template <class FunctorType> class GlTable : public DispatchTable<FunctorType> {
public:
    vector<shared_ptr<FunctorType>> functors;
};

class OpenGLRenderer : public Serializable {
    struct BodyDisp;
    vector<Vector3r> clipPlaneNormals;
    Vector3r viewDirection;
    GLViewInfo viewInfo;
    Vector3r highlightEmission0, highlightEmission1;
    vector<BodyDisp> bodyDisp;

    GlTable<GlBoundFunctor> boundDispatcher;
    GlTable<GlIGeomFunctor> geomDispatcher;
    GlTable<GlIPhysFunctor> physDispatcher;
    GlTable<GlShapeFunctor> shapeDispatcher;
    vector<string> boundFunctorNames, shapeFunctorNames, geomFunctorNames, physFunctorNames;
    shared_ptr<Scene> scene;

public:
    Vector3r dispScale;

    OpenGLRenderer() = delete;
    void init();
    ANCF_PACKAGED(OpenGLRenderer)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(GlExtraDrawer)
