// The one list of errors: code, and the sentence that goes with it.
#ifndef ANCF_ERROR_H
#define ANCF_ERROR_H

#define ANCF_ERRORS(X)                                                                                                 \
    X(ANCF_OK, "no error")                                                                                             \
    X(ANCF_E_MEMORY, "out of memory")                                                                                  \
    X(ANCF_E_EMPTY, "a model needs at least one node and one element")                                                 \
    X(ANCF_E_NODE, "an element refers to a node that does not exist, or twice to the same one")                        \
    X(ANCF_E_LOOSE, "no element ends at a node that moves: hold it, or leave it out")                                  \
    X(ANCF_E_NEXT, "'next' must be -1 or an element that starts at the node where this one ends, and be used once")    \
    X(ANCF_E_KIND,                                                                                                     \
      "kind must be a sum of 1 spring, 2 lumped mass, 4 reduced axial rule, 8 exact curvature, 16 engineering strain") \
    X(ANCF_E_LENGTH, "length must be finite and above zero")                                                           \
    X(ANCF_E_STIFFNESS, "ea must be finite and above zero, ei finite and not below zero")                              \
    X(ANCF_E_MASS, "rho_a must be finite and above zero, and an added mass finite and not below zero")                 \
    X(ANCF_E_DAMPING, "damping must be finite and not below zero")                                                     \
    X(ANCF_E_DRAG, "mass-proportional damping must be finite and not below zero")                                      \
    X(ANCF_E_SPRING, "a spring element has no bending stiffness: use an ANCF element")                                 \
    X(ANCF_E_STATE, "a position, slope or velocity is not finite")                                                     \
    X(ANCF_E_SLIDE, "a slide needs a free node of its own, a direction of length 1 and a finite point on its line")    \
    X(ANCF_E_FACTOR, "the mass matrix could not be factored")                                                          \
    X(ANCF_E_LAW, "the parameters of a contact or friction law are out of range")                                      \
    X(ANCF_E_GROOVE, "a groove needs finite sizes, a slope above 0 to pi/2, and walls that reach above its fillet")    \
    X(ANCF_E_INERTIA, "inertia must be finite and above zero")                                                         \
    X(ANCF_E_BEARING, "viscous and dry friction must be finite and not below zero")                                    \
    X(ANCF_E_RHO, "rho must be from 0 to 1")                                                                           \
    X(ANCF_E_STEP, "an implicit step does not converge, in however short parts")                                       \
    X(ANCF_E_EQUILIBRIUM, "no static equilibrium was found: the structure is a mechanism, or the tolerance too small")

typedef enum {
#define ANCF_ERROR_ENUM(code, text) code,
    ANCF_ERRORS(ANCF_ERROR_ENUM)
#undef ANCF_ERROR_ENUM
} ancf_error;

// The sentence for a code; never NULL.
const char* ancf_error_text(ancf_error code);

#endif
