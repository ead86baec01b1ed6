// SPDX-License-Identifier: GPL-2.0-or-later
// The contacts and couplings of a CableEngine in one step: found, gathered into the table of plugin/c, solved, given
// back. In that order in the source as well.
#pragma once

#include "CableElement.hpp"
#include "HollarsPhys.hpp"
#include "Mobility.hpp"

#include <memory>

extern "C" {
#include "ancf/contact.h"
#include "ancf/cross.h"
#include "ancf/step.h"
}

namespace yade {

class CableEngine;
class CableGeom;

class CableContacts {
    template <class T, void (*destroy)(T*)> struct Deleter {
        void operator()(T* p) const { destroy(p); }
    };
    std::unique_ptr<ancf_table, Deleter<ancf_table, ancf_table_destroy>> table;
    std::unique_ptr<ancf_boxes, Deleter<ancf_boxes, ancf_boxes_destroy>> boxes;
    std::unique_ptr<ancf_motion, Deleter<ancf_motion, ancf_motion_destroy>> motion;
    std::unique_ptr<ancf_apart, Deleter<ancf_apart, ancf_apart_destroy>> apart;
    int windows = 0; // pairs of segments that may meet while the boxes hold

    struct Entry { // of a body in the table
        Body::id_t id;
        Vector3r spinBefore; // as it would turn without the table [rad/s]
        int carrier;         // number in carryNodes where it moves with its knot, or -1
    };
    struct Row { // of a contact of YADE's in the table: its places are the contacts begin .. end-1
        CableGeom* geom;
        HollarsPhys* phys;
        int begin, end;
        Body::id_t first, second;
    };
    struct Pair { // of bodies, or of elements
        Body::id_t first = -1, second = -1;
        bool elements = false;
    };
    shared_ptr<std::atomic<bool>> inUse {new std::atomic<bool>(false)}; // what is shown, by functors of this step
    shared_ptr<CableView> shown {new CableView(inUse)};
    vector<shared_ptr<CableView>> views;       // shown before, to those who may read them still
    vector<std::shared_ptr<const void>> parts; // that those point to
    vector<int> awake;                         // elements whose bodies are in interactions
    vector<Entry> entries;                     // by number of the body in the table
    vector<Row> rows;
    vector<int> entryOfBody;   // (bodies) number in the table if that of `stamp` is `gathered`
    vector<long> stamp;        // (bodies)
    long gathered = 0;         // how often the table was filled
    vector<int> knotOfCarrier; // place in the table, or -1
    vector<std::pair<shared_ptr<Material>, Real>> covers; // by kind: material, radius
    vector<ancf_laws> laws;                               // of two kinds of cover
    long edition = 0;                                     // of MaterialWatch that they are mixed of
    int kinds = 0;
    vector<ancf_memory> memory;                     // friction between cables in the step before
    int firstCrossing = 0;                          // contact of the table at which those between cables begin
    bool outgrown = true;                           // an element has left its box: new ones in the next step
    Real plannedStep = 0;                           // O.dt that the boxes are for [s]
    vector<Real> after, shift;                      // fields: velocities with contacts, displacements besides
    const Real *velocity = nullptr, *way = nullptr; // what this step goes on with
    bool acted = false;                             // contacts or couplings, in this step
    Real untilFirst = 0;                            // from the middle of O.dt to that of the first step in it [s]
    Real lifted = 0;                                // see lift()
    Pair fullest;                                   // that stored most at the end of the last step

    void makeCover(const CableEngine& cable);
    void mixLaws(const CableEngine& cable);
    void plan(const CableEngine& cable);
    void lookAround(const CableEngine& cable);
    void placeBodies(const CableEngine& cable) const;
    int addBody(const CableEngine& cable, const Body& touched);
    ancf_side sideOf(const CableEngine& cable, const Body& touched, const Vector3r& at);
    void addContact(const CableEngine& cable, const Interaction& contact, int element);
    template <class F> bool find(const CableEngine& cable, F found) const;
    void addCouplings(const CableEngine& cable);
    void addCrossings(CableEngine& cable);
    void follow(const CableEngine& cable);
    Pair pairOf(int contact) const;
    static string nameOf(const Pair& pair);
    void giveBodies(const CableEngine& cable, Real passed);
    void giveRows(const CableEngine& cable) const;

public:
    shared_ptr<const CableView> view() const { return shown; }
    void reset(std::shared_ptr<const void> model); // which is no longer the engine's
    void keep(std::shared_ptr<const void> part);   // until nobody reads it
    void stepBegins();                             // of the engine: functors are through
    void build(CableEngine& cable);
    void planFor(const CableEngine& cable, Real step); // O.dt may have been set since the boxes were planned
    void disturb(); // places or velocities were set from outside: nothing rests, boxes are new

    void renew(const ancf_model* m, int node) const { ancf_table_renew(table.get(), m, node); } // its mass has changed
    bool begin(const CableEngine& cable, int steps); // that the cable takes in O.dt; false: there is nothing to gather
    void gather(CableEngine& cable);
    void solve(CableEngine& cable, const ancf_time& time, int step, int steps); // one of the cable's in O.dt
    void give(CableEngine& cable, const ancf_time& time);
    void look(CableEngine& cable);                               // after the step: do the boxes hold?
    void recall(vector<int>& pairs, vector<Real>& values) const; // what the next step remembers
    void remember(const vector<int>& pairs, const vector<Real>& values);

    const Real* newVelocity() const { return velocity; }
    const Real* displacement() const { return way; }              // besides that velocity times the step; null: none
    const vector<ancf_laws>& lawsOfKinds() const { return laws; } // of two kinds of cover
    int asleep(const CableEngine& cable) const;
    struct Energies { // of the last step [J]
        Real elastic; // in its end
        Real damped, rubbed;
        Real found;        // elastic, that its work has not stored: it was there, at its start
        Real given, taken; // work on bodies, and of bodies
    };
    Energies energies() const;
    void noteFullest();
    Real found() const;                                                // of these alone
    Vector3r velocityBefore(Body::id_t id, const Vector3r& arm) const; // of a body in the table, before it acted
    // Of contacts on an unknown, in the cable's last step [N s], [N m s].
    void impulseOn(Vector3r& impulse, const ancf_model* m, int dof) const;
    string mostFound() const; // name of the contact with the largest part of it in this step or the last; "": none
    Real lift() const { return lifted; } // of bodies, besides what their velocities do in a step [J]
};

} // namespace yade
