// SPDX-License-Identifier: GPL-2.0-or-later
// Energies by name, if O.trackEnergy.
#pragma once

#include <lib/base/openmp-accu.hpp>
#include <lib/serialization/Serializable.hpp>

#include <map>

namespace yade {

class EnergyTracker : public Serializable {
public:
    using mapStringInt = std::map<std::string, int>;
    OpenMPArrayAccumulator<Real> energies;
    mapStringInt names;
    vector<bool> resetStep;

    EnergyTracker();
    // id: -1 at first, then the number of the name; reset: starts from 0 in each step
    void add(const Real& value, const std::string& name, int& id, bool reset = false);
    void findId(const std::string& name, int& id, bool reset = false, bool newIfNotFound = true);
    void set(const Real& value, const std::string& name, int& id) { // not inside parallel regions
        if (id < 0) findId(name, id, false);
        energies.set(static_cast<size_t>(id), value);
    }
    Real getItem_py(const std::string& name);
    void setItem_py(const std::string& name, Real value);
    Real total() const;
    void clear();
    ANCF_PACKAGED(EnergyTracker)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(EnergyTracker)
