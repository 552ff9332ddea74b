/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plrun: a spec becomes numbers and pictures, with no C written.
 *
 *     spec --plgen--> C --cc--> shared object in a cache --dlopen--> descriptor --run--> rows: CSV, picture
 *                                                                        \--sweep--> a line for each set of params
 *
 * Nothing of the generator is linked in: plrun starts plgen, and the compiler, as a person would, with arguments as a
 * list and never through a shell, so that blanks in paths mean nothing.  What drives a model is its descriptor
 * (`pl_model`, runtime/plrt.h) and NAME_step alone, so that a row has the bits that the generated code has in any
 * other program.
 *
 * The files, in the order in which a run goes through them:
 *
 *     main.c      the column of calls
 *     options.c   the command line; what is plgen's own is passed on
 *     message.c   errors, with places in files; memory
 *     text.c      numbers as text: shortest digits, t as the decimal k h
 *     unfinished.c    what goes when plrun is ended before its time
 *     output.c    files that are written: whole, or not at all
 *     command.c   programs: found, started, what they say
 *     build.c     from a spec to a shared object.  The cache is keyed by everything that the object is made of: the
 *                 C, the runtime, the compiler and its flags; an object is made beside its place and renamed into
 *                 it, so two runs at a time do no harm
 *     machine.c   a loaded model, its numbers as doubles whatever its type
 *     table.c     CSV as spreadsheets write it, a line at a time, with places
 *     record.c    a table as samples of the inputs, resampled where its times are not those of the steps
 *     run.c       steps, and what watches them
 *     lanes.c     ... of runs that differ in tunable params, side by side
 *     device.c    ... on a device, by OpenCL
 *     show.c      which outputs and states are shown, and in which panels
 *     rows.c      the rows of a run as CSV, or as doubles
 *     plot.c      ... as a picture
 *     psd.c       ... as power spectral densities
 *     stats.c     ... as a line for each output: final and mean value, rms, extremes
 *     gnuplot.c   what draws pictures
 *     grid.c      the table of a sweep over ranges
 *     sweep.c     lines of params, and what a run with each comes to
 *     variants.c  the models that these take
 *     journal.c   the lines that are done, kept beside, from which an interrupted sweep goes on
 *     workers.c   the lines shared out to cores (OpenMP) and machines (MPI)
 *     fit.c       params to look for, records, and by how much outputs miss them at some values
 *     fitted.c    the values that come closest (GSL): intervals, correlations, profiles, a picture
 *     chart.c     error against time, with other solvers; a page that runs the model
 *
 * A param that the spec declares tunable changes without compiling (`retune`); any other is given to plgen as -D, and
 * compiled once for each value.  The line of a sweep depends on its params alone: who computes it, and when, does not
 * show.  Lines are written in the order of the table.
 *
 * In single runs what is wrong ends the program where it is found; in a sweep it is the text of the line's status, so
 * what a line needs returns its error as text, NULL where there is none. */
#ifndef PLRUN_H
#define PLRUN_H

#include "plrt.h"
#include "host/picture.h"

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>
#include <sys/types.h>

/* ---- message.c ---- */

enum { WRONG_DATA = 1, WRONG_USAGE = 2 };       /* exit status */

char *format(const char *pattern, ...) __attribute__((format(printf, 1, 2)));  /* on the heap */
_Noreturn void fail(int status, const char *message);   /* "plrun: error: ..." */
_Noreturn void wrong_usage(const char *message);
void say_note(const char *message);
void say_text(const char *text);                        /* warnings of another program, as they are */
void leave_notes_to_first(void);                        /* of several processes, which would say the same */
void *need(void *memory);                               /* not NULL, or the program ends */
void *grown(void *array, size_t count, size_t *room, size_t item); /* room for one more than `count` items */

/* A place in a file: `line` is the text of line `number`, of `length` bytes, `column` the offset in it */
struct place {
	const char *path;
	unsigned long number;
	const char *line;
	size_t length, column;
};
void say_at(struct place at, const char *message);
_Noreturn void fail_at(struct place at, const char *note, const char *message); /* note: NULL for none */

bool progress_wanted(void);                             /* a terminal, and a fifth of a second since the last line */
void progress(const char *line);
void progress_end(void);                                /* takes the line away */
void progress_always(void);                             /* where there is no terminal, too: lines */

/* ---- text.c ---- */

enum { LONGEST = 32 };                                  /* characters of a number and what follows it */
char *put_shortest(char *to, double value, bool single);/* in as few digits as read back the same; its end, no 0 */
/* k h: as a decimal where h is one of at most 15 digits, 6 if it is a float */
char *put_time(char *to, uint64_t k, double h, bool single);
double time_number(uint64_t k, double h, bool single);  /* what its text reads back as */
const char *shortest(double value, bool single);        /* on the heap */
bool read_number(const char *text, double *value);      /* all of it, finite, decimal */

/* ---- options.c ---- */

struct pair {
	const char *name, *value;
};
struct range {                          /* of a sweep: NAME=FROM:TO:COUNT[:log] */
	const char *name;
	double from, to;
	size_t count;
	bool log;
};
struct look {                           /* of a picture */
	bool log_x, log_y, log;                 /* log: said which */
	struct picture_look as;
};
struct cosines;                         /* psd.c */
struct options {
	const char *spec, *output;
	double until, every;                    /* [s]; below 0: not given */
	const char *input, *time;               /* the record, and the header of its times */
	struct pair *column, *definition;       /* input=header; params */
	size_t columns, definitions;
	const char **passed;                    /* plgen's own options, NULL-terminated */
	size_t passed_count, passed_room;
	bool plot;
	const char *plot_file;                  /* NULL: a window */
	const char *sweep;                      /* the file, or the first range as it was given; NULL: one run */
	struct range *range;
	size_t ranges;                          /* 0: of the file */
	bool peak, resume, stats, histories, units, raw, device;
	const char *show;                       /* NULL: the outputs */
	struct look look;
	const char **fit;                       /* params and initial values, NULL-terminated; NULL: no fit */
	double (*fit_range)[2];                 /* of each; 0, 0: none is given */
	const char **fit_record;
	size_t fits, fit_records;
	struct pair *sigma;
	size_t sigmas;
	bool profile;
	const struct cosines *window;           /* of a power spectral density; NULL: none */
	unsigned long segment;                  /* steps; 0: as the run is long */
	double overlap;                         /* parts of a segment */
	bool chart;
	const char *page;                       /* the page that plgen makes instead of a run; NULL: none */
	int jobs;                               /* 0: as many as there are cores */
};
void read_options(int argc, char **argv, struct options *o);

/* ---- grid.c ---- */

bool is_range(const char *text);                /* NAME=...; else a file's name */
struct range range_of(const char *text);
char *grid_text(const struct range *range, size_t ranges, size_t *length);        /* as CSV, on the heap */

/* ---- unfinished.c ---- */

struct unfinished {
	pid_t group;                            /* of programs; 0: none */
	const char *path;
	void (*remove)(const char *path);       /* NULL: nothing has to be */
	struct unfinished *next;
};
void watch_for_signals(void);                   /* before any other thread begins */
void say_when_interrupted(const char *text);
void unfinished_begins(void);                   /* no end comes until it is said what has begun: */
void unfinished_is(struct unfinished *u);       /* NULL: nothing has */
void unfinished_ends(struct unfinished *u);

/* ---- output.c ---- */

struct output;
FILE *output_open(const char *path, struct output **output);   /* path NULL: standard output */
void output_done(struct output *o, FILE *to);   /* all that was written is there, under its name */

/* ---- command.c ---- */

struct said {
	int status;                             /* exit status; 128 + the signal that ended it */
	char *out, *err;                        /* NUL-terminated */
	size_t out_length;
};
const char *folder_of_program(void);            /* of plrun itself; NULL: not known */
char *find_in_path(const char *name);           /* NULL: not there */
FILE *input_kept(void);                         /* our standard input as a file, for as many commands as read it */
/* The program argv[0], found in PATH, with `input` from its beginning on its standard input, or nothing.  NULL, or why
 * it could not be started. */
char *run_command(const char *const *argv, FILE *input, struct said *said);

/* ---- build.c ---- */

/* The bytes of anything in 128 bits (FNV-1a), as the names of files in the cache */
struct hash {
	unsigned __int128 value;
};
void hash_begin(struct hash *h);
void hash_bytes(struct hash *h, const void *bytes, size_t length);
void hash_text(struct hash *h, const char *text);       /* with its end, so that "a" "bc" is not "ab" "c" */
char *hash_name(const struct hash *h);                  /* 32 digits */
char *read_whole(const char *path, size_t *length);     /* NULL: errno */
const char *cache_folder(void);                         /* made when it is not there */

struct toolchain;                               /* plgen, the compiler, the runtime */
struct toolchain *find_tools(void);
const char *plgen_of(const struct toolchain *t);
const char *runtime_of(const struct toolchain *t);

/* The C of a spec, with `extra` definitions "NAME=EXPR" beside the options'.  Its messages are shown unless `quiet`;
 * NULL: it went wrong, *error says how, *status is plgen's. */
struct code {
	char *text;
	char *said;                             /* what plgen warned of */
	char *name;                             /* of the model */
	bool single;
	char **tunable;                         /* NULL-terminated */
};
/* Of the same model the kernel of a device, and what it is called; NULL: why there is none */
struct kernel *generate_kernel(const struct toolchain *t, const struct options *o, const char *const *extra,
			       size_t extras, const char *name, char **error);
struct code *generate(const struct toolchain *t, const struct options *o, const char *const *extra, size_t extras,
		      bool quiet, char **error, int *status);
bool is_tunable(const struct code *c, const char *name);
/* The C as a shared object: its path in the cache, compiled when it is not there.  NULL: *error.  anew: always, and
 * without what was compiled with plrun */
char *compile(const struct toolchain *t, const struct code *c, bool anew, char **error);
/* What its C is made of, for a key */
void hash_tools(const struct toolchain *t, struct hash *h);

/* ---- machine.c ---- */

struct machine {
	void *object;                           /* of dlopen */
	const pl_model *model;                  /* of a model in float its pl_modelf: `single` says which */
	const pl_modelf *modelf;
	bool single, has_status, can_retune; /* can_retune: to another step too */
	uint64_t (*crossed)(const void *s);     /* breakpoints, impacts included; NULL: the model counts none */
	/* NAME_allowed, of its type; NULL: steps do not look at their error */
	void (*allowed)(const void *s, double *y);
	void (*allowedf)(const void *s, float *y);
	const pl_derivatives *derivatives;      /* NULL: it has none; of a model in float its pl_derivativesf */
	const pl_derivativesf *derivativesf;
	const pl_many *many;                    /* NULL: runs do not go side by side; in float its pl_manyf */
	const pl_manyf *manyf;
	struct kernel *kernel;                  /* of a device; NULL: there is none */
	const char *name;
	int states, inputs, outputs, params;    /* outputs: those that are shown */
	int plain_outputs, own_outputs;         /* of the model; with their derivatives behind them */
	const int *shown;                       /* per output: its own, or behind them a state; NULL: all of its own */
	size_t size;
	double h;
	const char *const *input_names, *const *output_names, *const *state_names, *const *param_names;
	const pl_units *units;                  /* NULL: the model has none */
	const struct view *view;                /* what it shows */
	const int *ahead;                       /* of each input: samples that it has had before the first step */
	int most_ahead;
	double *param_values;
};
struct machine *machine_of(const struct toolchain *t, const struct code *c, char **error);
void machine_close(struct machine *m);
double param_value(const struct machine *m, int param, double value);     /* of its own unit, as retune takes it */

/* ---- show.c ---- */

struct panel {
	int x;                                  /* a column; -1: t */
	int curves, y[PICTURE_CURVES];          /* columns */
};
struct view {
	int panels, columns;
	struct panel *panel;
	int *source;                            /* per column: an output of the model, or behind them a state */
	const char **name, **unit, **label;     /* unit: "": none; label: the name with its unit */
};
struct view view_of(const struct machine *m, const char *text);     /* text: of --show, or NULL */
/* What it has from now on as outputs: a choice of --show, or its own, called as they are or with --units by labels */
void machine_show(struct machine *m, const struct view *v, const struct options *o);
const char *panel_label(const struct view *v, const struct panel *p);   /* of its curves: "" where they differ */
const char *psd_label(const struct view *v, const struct panel *p);
const char *param_label(const struct machine *m, const char *name);
/* In heights of a curve over t, with room for a legend and for what stands at the axis below */
double panel_height(const struct view *v, const struct panel *p, bool labelled);

struct instance {
	const struct machine *machine;
	void *state;
	void *derivatives;                      /* NULL: there are none */
	double *seed;                           /* by an input: the derivatives are by an offset of it */
	float *narrow;                          /* of models in float: room for any vector */
	double *all;                            /* where a choice is shown: outputs, then states */
};
struct instance *instance_new(const struct machine *m); /* as `init` leaves it */
void instance_free(struct instance *i);
const char *instance_retune(struct instance *i, const double *params, double h);    /* NULL, or what is wrong */
void instance_hold(struct instance *i, const double *u);
void instance_step(struct instance *i, const double *u);
/* n steps, of u a row for each, of out too; n <= STEPS_AT_ONCE, and outputs are the model's own */
void instance_run(struct instance *i, size_t n, const double *u, double *out);
void instance_jump(struct instance *i, uint64_t n);     /* where the model has it */
enum { STEPS_AT_ONCE = 64 };                    /* so that their rows stay in a cache */
void instance_out(struct instance *i, double *out);
void instance_get(struct instance *i, double *y);
void instance_allowed(struct instance *i, double *y);   /* where the machine has it */
int instance_status(const struct instance *i);
unsigned instance_doubt(const struct instance *i);    /* PL_D_... bits of its derivatives; 0 without */
/* Of bit 0, 1, ... of those the first event: its switching function, or -1, and time */
int instance_first_doubt(const struct instance *i, int bit, double *time);
void instance_move(struct instance *i, const double *offset);  /* adds it to the state, at t = 0 */
double instance_time(const struct instance *i);

/* ---- table.c ---- */

struct cell {
	size_t column;                          /* offset in the line */
	const char *text;                       /* without blanks and quotes, NUL-terminated; ends with the line */
	bool quoted;
};
struct table {
	const char *path;
	char *text;                             /* the whole file */
	size_t length, next;                    /* next: where the line after this one begins */
	struct place at;                        /* this line */
	char line_end, separator, point;        /* point: of numbers so far, 0: none had one */
	struct cell *cell;
	size_t cells, cell_room;
	char *words;                            /* the cells' texts */
	size_t words_room;
	struct cell *header;                    /* NULL: the first line has numbers */
	size_t columns;                         /* of the first line, and so of all */
	struct place header_at;
};
void table_open(struct table *t, const char *path);
void table_begin(struct table *t, const char *path, char *text, size_t length);   /* of a text, which it keeps */
bool table_next(struct table *t);                       /* false: at its end */
double table_number(struct table *t, size_t cell);      /* finite, or the program ends at its place */
struct place table_place(const struct table *t, size_t column);
struct place header_place(const struct table *t, size_t column);

/* ---- record.c ---- */

struct record {
	const char *path;
	int inputs, width;
	size_t rows;
	double *value;                          /* rows x width: inputs, then what outputs were, NAN: missing */
	double *time;                           /* [s] from the first on; NULL: row k is at k h */
	unsigned long last_line;
};
/* That many inputs and outputs of the machine, all or none; a record without inputs has its own times */
struct record *record_read(const struct options *o, const char *path, const struct machine *m, int inputs, int outputs);
/* Does row k stand at k h, for all k? Then samples are rows. */
bool record_on_grid(const struct record *r, double h);
#define MOST_STEPS (UINT64_C(1) << 53)
/* How many there are at 0, h, 2 h ...; no more than that many */
uint64_t record_samples(const struct record *r, double h, bool on_grid);
void record_say(const struct record *r, double h);      /* that it is resampled, where it is */
/* Sample k; *near is where the last one was found, 0 at first */
void record_sample(const struct record *r, double h, bool on_grid, uint64_t k, size_t *near, double *u);

/* ---- stats.c ---- */

struct output_stats {
	double last, least, most, peak;         /* peak: the largest |value| */
	double squares, low;                    /* their sum, in two parts: the same bits on every machine and device */
	long double sum, wide;                  /* wide: of squares that no double has, by stats_add alone */
	uint64_t peak_at;                       /* the first row that has it */
};
struct stats {                          /* of a run */
	int outputs;
	uint64_t rows;
	struct output_stats *of;                        /* per output */
};
struct stats stats_new(int outputs);
/* What a line of a sweep has, last value, squares and peak, of `rows` values of an output, from row k on, each `apart`
 * entries behind the one before; stats_add has all */
void stats_column(struct stats *s, int output, uint64_t k, size_t rows, const double *value, size_t apart);
void stats_add(void *who, uint64_t k, const double *out);
double stats_rms(const struct stats *s, int output);
bool stats_in_range(const struct stats *s);             /* do all have the sum of squares without `wide`? */
/* crossed: breakpoints; it counts where the machine counts them */
void stats_print(FILE *to, const struct stats *stats, const struct machine *m, double h, uint64_t crossed);

/* ---- run.c ---- */

struct job {
	const struct machine *machine;
	const struct record *record;            /* NULL: no inputs */
	const double *params;                   /* NULL: as the model has them */
	const double *offset;                   /* NULL, or what is added to each initial state */
	double h, until;                        /* until < 0: to the end of the record */
	bool resampled, reported;               /* reported: progress is */
	bool tuned;                             /* by run_steps: the model has taken the params */
	uint64_t steps;                         /* these two by plan_run */
	uint64_t apart;                         /* of the rows that are looked at; 0: all are */
	uint64_t *crossed;                      /* NULL, or where the number of breakpoints crossed goes */
};
char *plan_run(struct job *job);                        /* NULL, or why not */
typedef void watch(void *who, uint64_t k, const double *out);  /* after step k, and at k = 0 */
char *run_steps(struct job *job, watch *each, void *who);

struct samples;                                 /* of inputs, step by step */
/* hold: is called with what comes before the first step */
struct samples *samples_begin(const struct job *job, void (*hold)(void *who, const double *u), void *who);
const double *samples_rows(struct samples *s, size_t steps);    /* those of the next steps; at most STEPS_AT_ONCE */
void samples_end(struct samples *s);

/* ---- lanes.c ---- */

bool machine_has_lanes(const struct machine *m);
/* A run like the job for each set of params, to `stats`; done: false where it takes a run alone to say what is wrong.
 * Returns why a device that is wanted has done none, or NULL */
char *lanes_run(const struct job *job, size_t count, const double *const *params, struct stats *stats, bool *done);

/* ---- device.c ---- */

struct kernel;
enum { STEPS_ON_DEVICE = 16 * STEPS_AT_ONCE };  /* at a time */
struct batch_arrays {                   /* of NAME_instances and NAME_kernel, and how long */
	size_t count, rows, factors, shared, outputs;
	double *y, *factor, *peak, *sum;
};
struct kernel *kernel_of(const char *text, const char *name, char **error);    /* NULL: why there is none */
void kernel_free(struct kernel *k);
/* share: writes what all instances share in the next n steps. Returns NULL, or how it went wrong */
typedef void shared_rows(void *who, size_t n, double *now);
char *kernel_run(const struct kernel *k, const struct batch_arrays *a, uint64_t steps, shared_rows *share, void *who);

/* ---- rows.c, plot.c: what watches a run ---- */

struct rows;
/* raw: as doubles, without the line of names */
struct rows *rows_new(FILE *to, const struct machine *m, double h, uint64_t every, bool raw);
watch rows_add;
void rows_end(struct rows *r);

struct picture;
struct picture *picture_new(const struct machine *m, double h, uint64_t every);
watch picture_add;
/* `p`, a run of that label, drawn over the same axes as `last` and those before it; last: NULL, or as returned */
struct picture *picture_after(struct picture *last, struct picture *p, const char *label);
void picture_draw(struct picture *p, const struct options *o);  /* and those after it */
void picture_check(const struct view *v, const struct options *o);  /* may it be of a sweep? */
/* `lines`: of a sweep over one range or two, as printed, without their names; an empty one before each scan */
void picture_sweep(const struct machine *m, const struct options *o, const char *lines);

/* ---- gnuplot.c ---- */

struct script;
struct script *script_new(const struct look *look, const char *file, const char *title, const char *subtitle);
FILE *script_data(struct script *s);                    /* what stands before the panels */
FILE *script_panel(struct script *s, double height);    /* the next one, in heights of a curve over t */
/* Few enough numbers at an axis for any height; of a logarithmic one 1, 2, 5 of each decade where there are few */
void script_tics(FILE *to, char axis, double from, double end);
void script_log_tics(FILE *to, char axis, double from, double end);
void script_label(FILE *to, const char *what, const char *text);        /* set ylabel 'text' */
/* Curve k of a panel; one with a title has dashes and marks of its own */
void script_curve(FILE *to, int k, const char *data, const char *title, size_t points);
void script_draw(struct script *s);

/* ---- psd.c ---- */

struct psd;
bool is_window(const char *text);
void read_window(struct options *o, const char *text);  /* NULL: the default */
struct psd *psd_new(const struct machine *m, const struct options *o, double h, uint64_t steps);
watch psd_add;
void psd_print(FILE *to, const struct psd *p, const struct options *o);
void psd_draw(const struct psd *p, const struct options *o);

/* ---- fit.c, fitted.c ---- */

struct unknown {                        /* what a fit looks for */
	const char *name;
	int column, record;                     /* of the derivatives; of all records, or an initial value of one */
	int param, state;                       /* a tunable param; a state whose initial value it is; or -1 */
	double start, low, high, factor;        /* in the param's own unit, which has `factor` SI units */
};
struct fit;
struct fit_rows {                       /* of samples, over sigma */
	size_t rows;
	int unknowns;
	double *residual, *jacobian;            /* rows; rows x unknowns */
};
struct estimate {
	struct fit *fit;
	double *value, squares;                 /* per unknown; the sum of squares of residuals */
	bool *held;                             /* per unknown: at the end of its range, or given */
	struct fit_rows at;                     /* there */
};
int fit_run(const struct toolchain *t, const struct options *o, const struct code *c, const struct machine *m,
	    const double *params, FILE *to);  /* exit status */
/* With its records read; what it cannot look for is an error */
struct fit *fit_new(const struct toolchain *t, const struct options *o, const struct code *c, const struct machine *m,
		    const double *params);
void fit_say_cost(const struct fit *f);         /* evaluations, and whether each compiled the model */
int fit_unknowns(const struct fit *f, const struct unknown **unknown);
size_t fit_samples(const struct fit *f);
double unknown_clamped(const struct unknown *u, double value);  /* in its range */
/* Calls with the name of each output that was measured, the record's number, and rows of t, value and model */
typedef void fit_watch(void *who, const char *output, size_t record, size_t rows, const double *row);
/* Residuals at these values; returns how a run has failed, or NULL. each: NULL for none */
const char *fit_evaluate(struct fit *f, const double *value, struct fit_rows *to, fit_watch *each, void *who);
void fit_each(const struct estimate *e, fit_watch *each, void *who);

/* ---- chart.c ---- */

_Noreturn void make_page(const struct toolchain *t, const struct options *o);
_Noreturn void run_chart(const struct toolchain *t, const struct options *o);

/* ---- sweep.c, variants.c, journal.c, workers.c ---- */

/* Of several processes under mpirun this is number `rank` of `size`; else 0 of 1 */
struct workers {
	int rank, size;
};

struct journal;
struct variant {
	size_t row;                             /* the first that has it */
	size_t left;                            /* rows that are still to come */
	pthread_mutex_t busy;
	bool tried;
	struct machine *machine;                /* NULL, tried: `error` */
	char *error, *no_kernel;                /* no_kernel: why, where one is wanted */
};

struct param {
	const char *name;
	bool tuned, step;                       /* not tuned: by plgen */
};

struct sweep {
	const struct toolchain *tools;
	const struct options *options;
	const struct machine *machine;          /* at the values of the command line */
	const struct sweep *compiled;           /* as it is where params are not made tunable; NULL: they are not */
	time_t began;
	const struct record *record;
	struct param *param;
	size_t params, rows, rows_room;
	const char **text;                      /* rows x params */
	size_t *variant_of;                     /* row -> variant */
	struct variant *variant;
	size_t variants;
	FILE *to;                               /* of the first process: */
	struct journal *journal;
	char **line, *drawn;                    /* drawn: the lines for a picture */
	size_t drawn_length;
	FILE *to_draw;                          /* NULL: there is none */
	size_t written, done, before, failed;   /* before: done when it began */
	size_t host_runs, host_run;             /* of those wanted on a device; the first of them, and why */
	const char *host_why;
};

int sweep_run(const struct toolchain *t, const struct options *o, const struct code *c, const struct machine *m,
	      FILE *to, struct workers w);              /* exit status */

const char *sweep_value(const struct sweep *s, size_t row, size_t param);       /* as it is printed */
void find_variants(struct sweep *s);
bool is_name_of(const struct machine *m, const char *name);     /* of a tunable param */
void build_variant(const struct sweep *s, struct variant *v);
const struct machine *take_variant(struct sweep *s, struct variant *v);        /* NULL: v->error */
void leave_variant(struct variant *v);
enum { COMPILED_AT_MOST = 8 };                  /* variants; of more, what can be tunable is */
const struct code *make_tunable(struct sweep *s, const struct code *c);        /* the C of the sweep from now on */

struct journal *journal_open(const char *key, bool resume, size_t rows, char **line); /* line: those that are done */
void journal_add(struct journal *j, size_t row, const char *line);
void journal_end(struct journal *j);                    /* all is done: nothing stays */

struct workers workers_begin(int *argc, char ***argv);
void workers_end(void);
struct lines_wanted {                   /* lines 0 .. rows - 1 that are NULL */
	size_t rows;
	char **line;
	int jobs;                               /* threads of each process; 0: as many as there are cores */
	bool device;                            /* many lines at a time */
	/* These lines, by any thread; each ends with a newline */
	void (*compute)(void *who, const size_t *row, size_t count, char **line);
	/* In the first process, one at a time */
	void (*deliver)(void *who, size_t row, char *line);
	void *who;
};
void workers_share(struct workers w, const struct lines_wanted *of);

#endif
