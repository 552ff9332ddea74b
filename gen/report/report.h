/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was derived, for a person or a program to read. */
#ifndef PLGEN_REPORT_H
#define PLGEN_REPORT_H

#include "math/math.h"

struct pole_report;
struct step;
struct irrationals;
struct model;
struct series_switching;
struct switching;
struct alternative;
struct requirement;
struct modal_truncation;
struct output;
struct resolvent;
struct linear;
struct picture_look;

/* ---- report.c: poles and polynomials for a reader ---- */

const char *pole_text(const struct pole_report *report);
/* the pole, in so many columns; frequency, damping */
const char *pole_row(const struct pole_report *report);
const char *two_digits(double count);                       /* 5200, of 5234 */
double growth_rate(const struct step *step);                /* [1/s] */
const char *polynomial_text(int length, const mpq_t *c);    /* in s */
const char *irrationals_text(const struct irrationals *used); /* a sentence; NULL: there are none */
const char *relative_text(const struct model *model);       /* what is kept in the place of positions: X, r1 */
const char *json_text(const char *name);                    /* a file's name, as it is in quotes */
const char *json_number(double value);                      /* null where it is not finite, which JSON cannot say */
void json_numbers(FILE *to, int count, const double *value); /* [1, 2] */
void json_names(FILE *to, const char *key, int count, const char *const *name); /* a member: identifiers with primes */
void json_pole_list(FILE *to, int count, const struct pole_report *pole); /* a member, "poles" */
/* A member, row by row in lines of their own; of rows of a wider matrix, `stride` entries apart */
void json_matrix(FILE *to, const char *indent, const char *key, int rows, int columns, int stride, const double *value);
void json_rationals(FILE *to, const char *indent, const char *key, int rows, int columns, const mpq_t *value);
const char *breakpoints_text(int count, const mpq_t *at);   /* 1, 2 */
const char *rising_text(const struct series_switching *d);           /* likewise */

/* ---- units.c: of what is shown ---- */

enum listed { LISTED_STATE, LISTED_INPUT, LISTED_OUTPUT, LISTED_PARAM };
const char *unit_of_listed(const struct step *step, enum listed kind, int index); /* as its text; "": not known */
const char *labelled(const struct model *model, const char *name); /* of an output or input, as at an axis: f [kN] */
const char *units_text(const struct step *step);            /* a sentence; NULL: none are written */
void json_units(FILE *to, const struct step *step);          /* a member of an object, where some are */

/* ---- course.c: what a step does, in sentences that the C has, too ---- */

void text_scheme(FILE *to, const struct step *step);
const char *operations_text(const struct step *step);       /* 47 multiplications, 46 additions */
void text_peaks(FILE *to, const struct step *step);         /* what the look for them takes */
void text_rounding(FILE *to, const struct step *step);      /* of constants, and of the first steps */

/* ---- nonlinear.c: what poles and frequency responses would leave out ---- */

bool is_nonlinear(const struct step *step);
void text_nonlinear(FILE *to, const struct step *step);     /* what is not reported of it, and why */
void json_nonlinear(FILE *to, const struct step *step);     /* members of an object */
const char *stability_by_poles(int count, const struct pole_report *pole); /* by the largest real part */
void text_point(FILE *to, const struct step *step);         /* where they were linearised, where they were */
void json_point(FILE *to, const struct step *step);         /* a member of an object, or nothing */
void need_linear(const struct step *step, const char *what); /* "poles"; leaves the statement where it is not linear */

/* ---- equilibria.c: those that were found, and their linear equations ---- */

void text_symmetries(FILE *to, const struct model *model);  /* of coordinates, or nothing */
void json_symmetries(FILE *to, const struct model *model);  /* a member of an object */
/* `linear`: the linear equations at such a place, *why NULL; else why there are none */
void print_equilibria(FILE *to, const struct model *model, bool json,
		      const struct model *(*linear)(void *context, const char *place, const char **why), void *context);

/* ---- reach.c: what a series costs, and how far it reaches ---- */

void text_reach(FILE *to, const struct step *step);
void json_reach(FILE *to, const struct step *step);

/* ---- regions.c: formulas that the state chooses ---- */

void text_regions(FILE *to, const struct step *step);       /* of a model of straight pieces */
void text_region_list(FILE *to, const struct step *step);    /* each of them, and what their tables take */
void json_regions(FILE *to, const struct step *step);        /* members of an object */
void text_series_switching(FILE *to, const struct step *step); /* of a series */
void json_series_switching(FILE *to, const struct step *step); /* members of an object */

/* ---- contacts.c: contacts, friction and impacts beside a series ---- */

void text_contacts(FILE *to, const struct step *step);
void text_impact_rules(FILE *to, const struct model *model); /* of several at one instant, of bounces that end */
void json_contacts(FILE *to, const struct step *step);

/* ---- modes.c: steps in normal modes ---- */

void text_normal(FILE *to, const struct step *step);        /* what is exact, which way a step goes, its stability */
void text_frequencies(FILE *to, const struct step *step);
void json_normal(FILE *to, const struct step *step);         /* a member of an object */
void program_normal(FILE *to, const struct step *step);

/* ---- needs.c: what was chosen for needs, and from what ---- */

const char *alternative_text(const struct alternative *a);  /* float, delta */
const char *need_text(const struct requirement *r);         /* as written */
const char *certified_text(const struct alternative *a, int i); /* of a requirement: the bound and its parts */
const char *margin_text(const struct step *step, int i);    /* of the one taken, with the margin */
void text_needs(FILE *to, const struct step *step);
void json_needs(FILE *to, const struct step *step);          /* members of an object */

/* ---- modal_truncation.c: a model of some modes of another ---- */

/* of those that are kept, or of the others: 1-4, 6 */
const char *mode_numbers(const struct modal_truncation *s, bool kept);
int  modes_of_model(const struct modal_truncation *s);      /* how many it has, dropped ones too */
/* tip 3.2e-05: at most, by the start and the loads */
const char *truncation_text(const struct model *model, int output);
const char *static_correction_text(const struct model *model); /* what dropped modes still do */
void text_modal_truncation(FILE *to, const struct model *model);
void json_modal_truncation(FILE *to, const struct model *model); /* members of an object */

/* ---- transfer.c: transfer functions of the linear part ---- */

struct drive {                      /* what an output is a response to */
	const char *name;           /* of an input; of a load what it is in time: cos(5*t) */
	int input;                  /* -1: it is a load */
	int load, column, segment;  /* what it forces in this segment of time */
};
struct transfer {                   /* H(s) = scale N/D of an output over it, N and D coprime; N of length 0: it is 0 */
	const char *output, *drive;
	int input;                  /* -1: over a load */
	mpq_t scale;
	struct poly N, D;
	/* of frequency responses alone: over the same input as it was some time ago, which is added; NULL: none */
	const struct transfer *earlier;
	mpq_t delay;                /* this one's own [s] */
};
struct zero { double re, im; int multiplicity; bool pair; }; /* [1/s]; a pair: it and its conjugate */
bool is_reported(const struct output *output);              /* it is linear in states, loads and inputs, and no peak */
int  drives_of(const struct model *model, struct drive **drives); /* inputs, then loads; returns how many */
/* by drives, then by outputs; `r`: of the model's system */
int  transfers_of(struct resolvent *r, const struct model *model, struct transfer **list);
bool static_gain(const struct transfer *t, mpq_ptr gain);   /* H(0); false: there is a pole at 0 */
int  zeros_of_transfer(const struct model *model, const struct transfer *t, struct zero **list);
/* |H(2 pi i f)|, what is earlier counted, and its angle [deg], -180 <= angle < 180, each rounded once; of a pole:
 * infinite */
void transfer_at(const struct transfer *t, double hertz, double *size, double *angle);

struct angle_course {               /* of an angle: how the zeros and poles turn it */
	int zeros, poles;
	struct zero *zero, *pole;
	double start;               /* [deg], 0 or -180: what H is near 0, its powers of s left out */
};
struct angle_course angle_course_of(const struct model *model, const struct transfer *t);
/* The same angle, with the whole turns that lead to it from frequency 0 */
double angle_on_course(const struct angle_course *c, double hertz, double angle);

/* ---- shapes.c: mode shapes ---- */

struct mode_shape {                      /* of a pole; one entry per coordinate, the largest 1 */
	const struct pole_report *pole;
	double *re, *im;
};
/* one for each pole or pair of poles; of more than LIMIT_SHAPES coordinates none */
int  shapes_of(const struct linear *system, int count, const struct pole_report *pole, struct mode_shape **list);

/* ---- space.c: shapes, zeros, static gains and state space, for --explain ---- */

/* of the model whose poles are reported */
int  shapes_of_step(const struct step *step, struct mode_shape **shape, const struct model **of);
const char *zeros_text(const struct model *model, const struct transfer *t);
const char *static_gain_text(const struct transfer *t);
void text_linear(FILE *to, const struct step *step);
void json_linear(FILE *to, const struct step *step);         /* members of an object */

/* ---- frf.c: frequency responses ---- */

struct band { double from, to; int count; };                 /* [Hz], in equal ratios */
bool read_number(const char *text, const char *end, double *number); /* up to `end`; false: it is none */
struct band band_of(const char *text);                       /* F0:F1[:N] of the command line; leaves the statement */
double frequency_of(const struct band *band, int row);
struct band band_of_poles(int count, const struct pole_report *pole, int rows); /* around them */
struct responses {                  /* [row][transfer]; angles [deg] with the turns from frequency 0 on, but of sums */
	struct band band;
	int count;
	struct transfer *transfer;
	double *size, *angle;
};
struct responses responses_of(const struct step *step, struct band band);
/* Of each frequency a row: it, then sizes and angles, of 12 digits where there are several ways through the band */
void print_rows(FILE *to, const struct band *band, int count, int ways, double *const *size, double *const *angle,
		char between);
/* as CSV; with an amplitude of the excitation, as below */
void print_response(FILE *to, const struct step *step, const char *band, const char *amplitude);

/* ---- period.c: what a sweep is made of: movers, the independent parts of a model with regions, or the whole ---- */

enum { WORK = 7 };
struct mover {
	const struct switching *of;     /* its regions */
	const int *place;               /* per state: of the model's; NULL: the same */
	int states, size;               /* of z = [y, a cos(w t), a sin(w t), 1] */
	int systems;
	double **A, **at, **E;          /* per system, of z: all but w; at w; e^{A h} of it, where known */
	bool *known;
	double **row, **row_at, **limit; /* per expression: over z, likewise at w; its breakpoints */
	double rate;                    /* largest modulus of a pole in any region [1/s] */
	double amplitude, w, period;    /* a; [rad/s]; [s] */
	int samples;                    /* in a period, between which crossings are looked for */
	/* of the last period: crossings; per state the integral of y e^{-iwt}, real and imaginary */
	int crossings;
	double *integral[2];
	double *work[WORK], *square[3], *piece;
};
/* of a model with `switching`; returns how many. The excitation is a cos(w t) in the place of what drives; other loads
 * that are constant act, and nothing else does */
int  movers_of(const struct model *model, const struct drive *drive, struct mover **list);
void mover_tune(struct mover *m, double w);
/* y becomes that a period later. M, states x states, how it follows from y, and scale, per state the largest size on
 * the way, where they are not NULL; scale is only enlarged; without it the integrals are left at 0 */
void mover_period(struct mover *m, double *y, double *M, double *scale);
/* of an output over [y, a cos(w t), u'/w of it, 1], as it is written: states and OVER */
double *output_over(const struct model *model, int output, const struct drive *drive);

/* ---- sweep.c: of models that are linear between breakpoints ---- */

struct swept {                      /* an output over an excitation */
	const char *output, *drive;
	int drive_index;
	double *over;               /* states, u, u'/u in time, 1 */
};
struct sweeps {                     /* up, then down; else as above */
	struct band band;
	int count, unsettled;       /* frequencies of both at which the motion does not repeat with the excitation */
	struct swept *of;
	double *size[2], *angle[2]; /* of the harmonic of the excitation's frequency, over its amplitude */
};
bool can_be_swept(const struct step *step);
double amplitude_of(const char *text);                      /* of the command line; leaves the statement */
struct sweeps sweeps_of(const struct step *step, struct band band, double amplitude);

/* ---- gnuplot.c ---- */

FILE *new_script(void);                                     /* a file without a name */
void copy_file(FILE *from, FILE *to);                       /* from its start */
void draw(FILE *to, FILE *script);                          /* what gnuplot makes of it; it is said where it cannot */

/* ---- poles.c, plot.c: pictures ---- */

/* $poles, and the commands of a panel, beside which so many lines of text have room */
const char *draw_poles(FILE *data, const struct step *step, int lines);

#define PICTURE_KINDS "response, poles, modes and frf, with commas between, or campbell"
enum picture_format { PICTURE_NONE, PICTURE_SVG, PICTURE_PNG, PICTURE_PDF, PICTURE_CSV, PICTURE_JSON };
const char *wrong_picture(const char *list);                /* of KIND,...: one that is none; NULL: all are */
enum picture_format picture_of_file(const char *path);      /* by its ending; NULL: SVG */
/* For gnuplot its terminal, its colours (ink, frame, faint), a font (small); name: of what is drawn, commas between */
void begin_picture(FILE *to, const struct picture_look *look, enum picture_format as, int width, int height,
		   const char *name);
bool has_frf(const char *list);                             /* of kinds, none of them wrong */
/* amplitude: of the excitation that frf sweeps with; NULL: it does not */
void print_picture(FILE *to, const struct step *step, const char *list, const char *amplitude,
		   const struct picture_look *look, enum picture_format as);
void picture_in_page(FILE *to, const struct step *step, const char *kind, bool dark);   /* inline SVG */

/* ---- page.c ---- */

/* HTML, with everything in it */
const char *html_text(const char *text);         /* < > & and quotes escaped */
void print_page(FILE *to, const struct step *step, const char *options, const struct picture_look *look,
		const char *live);              /* a page that runs the model, in a frame; NULL: none */

/* ---- program.c, explain.c, json.c, solution.c ---- */

void explain_program(FILE *to, const struct step *step);    /* what a step does, before it is C */

void explain_text(FILE *to, const struct step *step);
void text_written(FILE *to, const struct step *step);       /* the equations as written */
void text_linear_part(FILE *to, const struct step *step);   /* B(s) and its poles */
void text_equations(FILE *to, const struct step *step);     /* as written, and what a network or an assembly means */
void text_course(FILE *to, const struct step *step);        /* what is exact, and what is done with what is not */
void text_cost(FILE *to, const struct step *step);          /* and how far a step may be off */
void explain_json(FILE *to, const struct step *step);
void print_solution(FILE *to, const struct model *model, struct resolvent *written, mpq_srcptr end);

#endif
