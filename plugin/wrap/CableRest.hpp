// SPDX-License-Identifier: GPL-2.0-or-later
// What the cables of an engine may touch while they come to rest: the bodies of the scene, for plugin/c.
#pragma once

#include "HollarsPhys.hpp"

#include <core/Body.hpp>

#include <map>
#include <memory>

extern "C" {
#include "ancf/rest.h"
}

namespace yade {

class CableEngine;

class CableRest {
    struct Deleter {
        void operator()(ancf_rest* p) const { ancf_rest_destroy(p); }
    };
    const CableEngine& cable;
    vector<const Body*> kinds;  // an element's body for each kind of cover
    vector<const Body*> bodies; // of the obstacles
    vector<ancf_obstacle> obstacles;
    vector<vector<ancf_normal>> laws;          // (obstacles) of each kind of cover
    std::map<Body::id_t, vector<int>> without; // elements that never touch a body
    vector<ancf_obstacle_pair> pairs;
    std::unique_ptr<ancf_rest, Deleter> rest;

    ancf_normal lawOf(const Body& first, const Body& second) const;
    void readElements();
    void addBody(const Body& body);
    void addPairs();
    bool cablesMeet() const;

public:
    explicit CableRest(const CableEngine& cable); // of a built engine, and shorter than it
    ancf_rest* get() const { return rest.get(); } // null: there is nothing to touch

    // At rest: what a body does that the cables press on and that would not stay where it is; empty: there is none.
    string moved() const;
};

} // namespace yade
