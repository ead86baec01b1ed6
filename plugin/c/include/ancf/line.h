// A line that runs through rings: its material slides through them, from span to span, and onto a drum at either end.
//
// It has no mass and no bending stiffness. A span between two places is straight, with the tension EA (way/length - 1)
// of its unstressed length, or slack. What flows through a ring is what Eytelwein's equation asks for: where the
// tensions on both sides differ by less than exp(mu angle), nothing does, and otherwise as much as brings them there.
// A ring has a size: the way of a line between two centres at the distance d is sqrt(d^2 + r^2), so that rings may
// meet.
#ifndef ANCF_LINE_H
#define ANCF_LINE_H

#include "error.h"
#include <stdbool.h>

// What holds an end of a line. It draws at `speed` while that takes no more tension than `force`, else more slowly or
// not at all; it holds up to `brake` and lets out above. Below 0, speed lets out.
typedef struct {
    double speed; // unstressed length a time [m/s]
    double force; // [N], at most `brake`
    double brake; // [N]; INFINITY: holds whatever comes
    double least; // unstressed length of the whole line at which it stops to draw in [m]
    double most;  // and to let out by its speed [m]; INFINITY: never
} ancf_winch;

// What an end does.
typedef enum {
    ANCF_HOLDS,   // nothing passes
    ANCF_DRAWS,   // what its speed asks for
    ANCF_STRAINS, // less than that: at its force
    ANCF_SLIPS,   // lets out at the brake's force
} ancf_drum;

typedef struct {
    int spans;           // between spans + 1 places, of which all but the first and last are rings
    double ea;           // [N]
    double radius;       // of a ring [m]
    ancf_winch winch[2]; // at the first place and at the last
    double* friction;    // (spans + 1) coefficient of each place [-]; those at the ends are not used
    double* length;      // (spans) unstressed [m]
    double* tension;     // (spans) [N]
    int* slides;         // (spans + 1) of a ring: 1 towards higher spans, -1, or 0; of an end: ancf_drum
    double rubbed;       // work of friction at rings so far [J]
    double drawn;        // work of the winches on the line so far, less what is stored in what they wound up [J]
    long unsettled;      // steps in which no state of all rings was found that agrees with every law
    // Found at the positions last given:
    double* way;        // (spans) [m]
    double (*along)[3]; // (spans) pull on the place before it, over the tension; on the one behind it the other way
    double* flow;       // (spans + 1) unstressed length that passed a place towards higher spans in that step [m]
    double* work;       // for a step
} ancf_line;

// All lengths, tensions and frictions are zero, and the ends hold. ANCF_E_MEMORY, ANCF_E_EMPTY for less than one span.
ancf_error ancf_line_create(ancf_line** line, int spans, double ea, double radius);
void ancf_line_destroy(ancf_line* line);

// Ways, and directions, with places at x (spans + 1).
void ancf_line_lay(ancf_line* line, const double (*x)[3]);

// The end of a step of length dt: places are at x. Material flows, and tensions are those of now.
void ancf_line_step(ancf_line* line, const double (*x)[3], double dt);

// Force of the line on a place [N].
void ancf_line_pull(double force[3], const ancf_line* line, int place);

// Elastic energy [J].
double ancf_line_energy(const ancf_line* line);

double ancf_line_length(const ancf_line* line); // unstressed, of all spans [m]

// An upper bound of the squared angular frequency of bodies of inverse masses (spans + 1) [1/kg] on the line, while no
// way is shorter than `share` of what it is now, or than a ring's radius if that is more. A place that the line comes
// to m times has m times its inverse mass.
double ancf_line_frequency2(const ancf_line* line, const double* inverse_mass, double share);

#endif
