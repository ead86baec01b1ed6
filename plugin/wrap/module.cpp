// SPDX-License-Identifier: GPL-2.0-or-later
// The compiled module ancf._ancf: checks the running YADE, then registers our classes with it.
#include "LayoutCheck.hpp"
#include "View3d.hpp"

#include <core/Omega.hpp>
#include <lib/base/AliasNamespaces.hpp>
#include <lib/factory/ClassFactory.hpp>

using namespace yade;

// Private in YADE: tells Python and the inheritance tree about classes.
void buildDynlibDatabase(Omega*, const std::vector<std::string>&) asm(
    "_ZN4yade5Omega19buildDynlibDatabaseERKSt6vectorINSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEESaIS7_EE");

namespace {

// Names of all classes, from the YADE_PLUGIN lines of the sources.
const std::vector<std::string> classNames {
#include "classNames.inc"
};

py::object wrapper() { return py::import("yade.wrapper"); }

bool known(const std::string& name) { return PyObject_HasAttrString(wrapper().ptr(), name.c_str()); }

// YADE would silently keep the older class.
void refuseTakenNames() {
    for (const auto& name : classNames)
        if (known(name)) throw std::runtime_error("ancf: YADE already has a class called " + name);
}

void registerFactories() {
#ifdef ANCF_PACKAGED_YADE
    for (const auto& c : pendingClasses())
        if (!ClassFactory::instance().registerFactorable(c.name, c.createRaw, c.createShared, c.createCustom))
            throw std::runtime_error(std::string("ancf: YADE already has a class called ") + c.name);
#endif
}

// YADE swallows what goes wrong while it registers.
void requireRegistered() {
    for (const auto& name : classNames)
        if (!known(name)) throw std::runtime_error("ancf: YADE did not accept the class " + name);
}

void registerClasses() {
    refuseTakenNames();
    registerFactories();
    buildDynlibDatabase(&Omega::instance(), classNames);
    requireRegistered();
}

int checkLayoutFromPython(const py::dict& overrides) {
    std::map<std::string, long> numbers;
    const py::list items = overrides.items();
    for (py::ssize_t i = 0; i < py::len(items); ++i)
        numbers[py::extract<std::string>(items[i][0])()] = py::extract<long>(items[i][1])();
    try {
        return ancf::checkLayout(numbers);
    } catch (const ancf::LayoutMismatch& e) {
        PyErr_SetString(PyExc_ImportError, e.what());
        py::throw_error_already_set();
    }
    return 0;
}

void fill(py::object module) {
    const py::scope scope(module);
    py::def("_checkLayout", &checkLayoutFromPython, py::arg("overrides") = py::dict(),
            "Checks YADE's memory layout, with our number of a fact replaced; ImportError names what does not fit.");
    py::def("_refreshView", &ancf::refreshView, py::arg("renderer"),
            "Lets yade.qt.Renderer() know how our shapes are drawn, where yade.qt was imported before us.");
    py::list names;
    for (const auto& name : classNames) names.append(name);
    module.attr("classNames") = names;
}

PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "_ancf", "Compiled part of ancf.", -1, nullptr, nullptr, nullptr, nullptr, nullptr};

} // namespace

// Written by hand: BOOST_PYTHON_MODULE would hide the error.
extern "C" __attribute__((visibility("default"))) PyObject* PyInit__ancf() {
    PyObject* module = PyModule_Create(&definition);
    if (!module) return nullptr;
    try {
        ancf::checkLayout({});
        registerClasses();
        fill(py::object(py::handle<>(py::borrowed(module))));
        return module;
    } catch (const py::error_already_set&) {
    } catch (const std::exception& e) {
        PyErr_SetString(PyExc_ImportError, e.what());
    }
    Py_DECREF(module);
    return nullptr;
}
