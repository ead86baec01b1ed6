// SPDX-License-Identifier: GPL-2.0-or-later
// The whole simulation.
#pragma once

#include <core/Body.hpp>
#include <core/BodyContainer.hpp>
#include <core/Cell.hpp>
#include <core/EnergyTracker.hpp>
#include <core/Engine.hpp>
#include <core/ForceContainer.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Material.hpp>

namespace yade {

class OpenGLRenderer;
class DisplayParameters;

class Scene : public Serializable {
    const unsigned hostNameMax = 255;

public:
    ForceContainer forces;
    Eigen::Matrix<Real, 10, 1> SpeedElements;
    shared_ptr<OpenGLRenderer> renderer;

private:
    long prevTime_; // ticks

public:
    Real dt;
    long iter;
    bool subStepping;
    int subStep;
    Real time;
    Real speed;
    long stopAtIter;
    Real stopAtTime;
    bool isPeriodic;
    bool trackEnergy;
    bool doSort;
    bool runInternalConsistencyChecks;
    Body::id_t selectedBody;
    int subdomain;
    shared_ptr<Shape> subD;
    vector<string> tags;
    vector<shared_ptr<Engine>> engines; // never change it inside an action
    vector<shared_ptr<Engine>> _nextEngines;
    shared_ptr<BodyContainer> bodies;
    shared_ptr<InteractionContainer> interactions;
    shared_ptr<EnergyTracker> energy;
    vector<shared_ptr<Material>> materials;
    shared_ptr<Bound> bound;
    shared_ptr<Cell> cell;
    vector<shared_ptr<Serializable>> miscParams;
    vector<shared_ptr<DisplayParameters>> dispParams;

    Scene();
    shared_ptr<Engine> engineByName(const string& className);
    bool timeStepperPresent();
    bool timeStepperActive();
    void moveToNextTimeStep();
    ANCF_PACKAGED(Scene)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Scene)
