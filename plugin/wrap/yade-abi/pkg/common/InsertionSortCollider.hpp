// SPDX-License-Identifier: GPL-2.0-or-later
// The usual collider.
#pragma once

#include <pkg/common/Collider.hpp>

namespace yade {

class NewtonIntegrator;

class InsertionSortCollider : public Collider {
public:
    bool strideActive;

private:
    void* sortedBounds_[3][6]; // one sorted list per axis, not to be touched
    vector<Real> maxima_, minima_;

public:
    bool periodic;
    Vector3r invSizes;
    int sortAxis;
    bool allowBiggerThanPeriod;
    bool sortThenCollide;
    int targetInterv;
    Real overlapTolerance;
    Real updatingDispFactor;
    Real verletDist;
    Real minSweepDistFactor;
    Real fastestBodyMaxDist;
    int numReinit;
    int numAction;
    bool doSort;
    bool keepListsShort;
    bool smartInsertErase;
    shared_ptr<NewtonIntegrator> newton;

    InsertionSortCollider();
    bool isActivated() override;
    void action() override;
    vector<Body::id_t> probeBoundingVolume(const Bound&) override;
    void invalidatePersistentData() override;
    ANCF_PACKAGED(InsertionSortCollider)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(InsertionSortCollider)
