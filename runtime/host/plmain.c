/* SPDX-License-Identifier: MIT-0 */
/* A driver for hosts: runs one model and writes its outputs as CSV.
 *
 *     cc -Iruntime runtime/host/plmain.c model_pl.c runtime/turns.c ... -DMODEL=scs -o m
 *     ./m 30 < inputs.csv > out.csv
 *
 * A model made with --real float is compiled with -DFLOAT too.  Tunable params, and the step, take other values on the command
 * line: ./m 30 k2=60 step=0.005.
 *
 * One row at every step k*h <= T, from t = 0 on.  A model with inputs reads one row of samples per step from standard
 * input: as many numbers as inputs, separated by commas; a first line that gives the inputs' names may precede them.
 * A run that leaves the finite numbers ends there, with exit status 1 and the rows before it written. */
#include "plrt.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef MODEL
#error "say which model to drive: -DMODEL=NAME, with the name that the generated code bears"
#endif
#define JOIN(a, b) a##b
#define DESCRIPTOR(name) JOIN(name, _model)

#ifdef FLOAT
typedef float real;
typedef pl_modelf descriptor;
enum { DIGITS = 9, BITS = 24 };
#else
typedef double real;
typedef pl_model descriptor;
enum { DIGITS = 17, BITS = 53 };
#endif

extern const descriptor DESCRIPTOR(MODEL);

static const descriptor *const model = &DESCRIPTOR(MODEL);

static void fail(const char *what)
{
    fprintf(stderr, "%s: error: %s\n", model->name, what);
    exit(1);
}

static void *need(void *memory)
{
    if (memory == NULL)
        fail("out of memory");
    return memory;
}

/* ---- the samples on standard input ---- */

typedef struct samples {
    char *line; /* without its end, NUL-terminated; `room` bytes */
    size_t room, length;
    unsigned long number; /* of the line, from 1 */
    int again;            /* this line was read ahead and is to be read once more */
} samples;

static void bad_input(const samples *in, size_t column, const char *what)
{
    fprintf(stderr, "<stdin>:%lu:%lu: error: %s\n", in->number, (unsigned long)column + 1, what);
    if (in->length != 0)
        fprintf(stderr, "%s\n%*s^\n", in->line, column < 10000 ? (int)column : 0, "");
    exit(1);
}

static int next_line(samples *in)
{
    int c;
    if (in->again) {
        in->again = 0;
        return 1;
    }
    in->length = 0;
    in->number++;
    while ((c = getchar()) != EOF && c != '\n') {
        if (in->length + 2 > in->room) {
            in->room *= 2;
            in->line = (char *)need(realloc(in->line, in->room));
        }
        in->line[in->length++] = (char)c;
    }
    if (ferror(stdin))
        fail("cannot read standard input");
    if (in->length != 0 && in->line[in->length - 1] == '\r')
        in->length--;
    in->line[in->length] = '\0';
    return c != EOF || in->length != 0;
}

static const char *skip_blanks(const char *p)
{
    while (*p == ' ' || *p == '\t')
        p++;
    return p;
}

/* What must follow column i. */
static char separator(int i)
{
    return i + 1 < model->inputs ? ',' : '\0';
}

/* A first line that starts as a name does gives the names, in the model's order; else it is the first sample. */
static void read_header(samples *in)
{
    const char *p;
    int i;
    if (!next_line(in))
        bad_input(in, 0, "expected samples of the inputs, found the end of the file");
    p = skip_blanks(in->line);
    if (*p != '_' && !(*p >= 'A' && *p <= 'Z') && !(*p >= 'a' && *p <= 'z')) {
        in->again = 1;
        return;
    }
    for (i = 0; i < model->inputs; i++) {
        const char *const name = skip_blanks(p), *const expected = model->input_names[i];
        p = skip_blanks(name + strcspn(name, " \t,"));
        if (strncmp(name, expected, strlen(expected)) != 0 || strcspn(name, " \t,") != strlen(expected)
            || *p != separator(i)) {
            fprintf(stderr, "<stdin>:%lu:%lu: error: expected the input '%s'%s\n%s\n", in->number,
                    (unsigned long)(name - in->line) + 1, expected, separator(i) ? " and a ','" : " and the end of the line",
                    in->line);
            exit(1);
        }
        p += *p == ',';
    }
}

static void read_sample(samples *in, real *u)
{
    const char *p;
    char *end;
    int i;
    if (!next_line(in))
        bad_input(in, 0, "too few samples: expected a row for every step, found the end of the file");
    p = in->line;
    for (i = 0; i < model->inputs; i++) {
        p = skip_blanks(p);
        u[i] = (real)strtod(p, &end);
        if (end == p)
            bad_input(in, (size_t)(p - in->line), "expected a number");
        if (u[i] - u[i] != 0)
            bad_input(in, (size_t)(p - in->line), "expected a finite number");
        p = skip_blanks(end);
        if (*p != separator(i))
            bad_input(in, (size_t)(p - in->line),
                      separator(i) ? "expected ',': one column for each input" : "expected the end of the line");
        p += *p == ',';
    }
}

/* ---- the run ---- */

static void print_header(void)
{
    int i;
    printf("t");
    for (i = 0; i < model->outputs; i++)
        printf(",%s", model->output_names[i]);
    printf("\n");
}

static void print_row(const void *state, real *out)
{
    int i;
    model->out(state, out);
    printf("%.*g", DIGITS, (double)model->time(state));
    for (i = 0; i < model->outputs; i++)
        printf(",%.*g", DIGITS, (double)out[i]);
    printf("\n");
    if (ferror(stdout))
        fail("cannot write to standard output");
}

/* After a step: what a model has a status for ends the run, at the time that the step led to. */
static void check_status(const void *state)
{
    const int status = model->status != NULL ? model->status(state) : 0;
    if (status == 0)
        return;
    if (fflush(stdout) != 0)
        fail("cannot write to standard output");
    fprintf(stderr, "%s: error: t = %.*g: ", model->name, DIGITS, (double)model->time(state));
    if (status == PL_NOT_FINITE)
        fprintf(stderr, "the step has left the finite numbers\n");
    else
        fprintf(stderr, "status %d\n", status);
    exit(1);
}

/* The last k with k h <= end.  Since h and the quotient are rounded, what is a whole number but for that counts as whole. */
static uint64_t steps_until(double end, double h)
{
    const double steps = end / h;
    if (!(steps < 9007199254740992.0)) {
        fprintf(stderr, "%s: error: T is more than 2^53 steps\n", model->name);
        if (!((double)model->h > 1e-300)) /* as the other type's descriptor reads */
            fprintf(stderr, "note: -DFLOAT is for models made with --real float, and for no others\n");
        exit(2);
    }
    return (uint64_t)(steps + 1e-9 + steps * (BITS == 24 ? 0x1p-23 : 0x1p-52));
}

static void usage(const char *program)
{
    int i;
    fprintf(stderr, "usage: %s T%s %s> out.csv\n    T: time of the end [s]; the step is %.*g s\n", program,
            model->retune != NULL ? " [NAME=VALUE ...]" : "", model->inputs > 0 ? "< inputs.csv " : "", DIGITS, (double)model->h);
    for (i = 0; i < model->params; i++)
        fprintf(stderr, "    %s=%.*g\n", model->param_names[i], DIGITS, (double)model->param_values[i]);
    if (model->retune != NULL)
        fprintf(stderr, "    step=%.*g\n", DIGITS, (double)model->h);
    exit(2);
}

static double end_of_run(int argc, char **argv)
{
    char *rest = NULL;
    double end = argc >= 2 ? strtod(argv[1], &rest) : 0.0;
    if (argc < 2 || rest == argv[1] || *rest != '\0' || end - end != 0.0 || end < 0.0) {
        if (argc >= 2)
            fprintf(stderr, "%s: error: expected a time, finite and not negative, found '%s'\n", model->name, argv[1]);
        usage(argc > 0 ? argv[0] : model->name);
    }
    return end;
}

/* ---- other values of the params ---- */

/* The place for the value of a param, or of the step; NULL: there is none of this name */
static real *place_of(const char *text, size_t length, real *params, real *h)
{
    int i;
    for (i = 0; i < model->params; i++)
        if (strlen(model->param_names[i]) == length && strncmp(model->param_names[i], text, length) == 0)
            return &params[i];
    return length == 4 && strncmp(text, "step", 4) == 0 ? h : NULL;
}

/* NAME=VALUE ...: params and h, as the model has them where they are not named */
static void read_values(int count, char **text, const char *program, real *params, real *h)
{
    int i;
    *h = model->h;
    for (i = 0; i < model->params; i++)
        params[i] = model->param_values[i];
    for (i = 0; i < count; i++) {
        const size_t length = strcspn(text[i], "=");
        char *rest = NULL;
        real *place = model->retune != NULL && text[i][length] == '=' ? place_of(text[i], length, params, h) : NULL;
        const double value = place != NULL ? strtod(text[i] + length + 1, &rest) : 0.0;
        if (place == NULL || rest == text[i] + length + 1 || *rest != '\0') {
            fprintf(stderr, "%s: error: expected %s, found '%s'\n", model->name,
                    model->retune != NULL ? "NAME=VALUE, a tunable param or step, and a number" : "nothing after the time: the model has no tunable params",
                    text[i]);
            usage(program);
        }
        *place = (real)value;
    }
}

static void retune(void *state, const real *params, real h)
{
    const int status = model->retune(state, params, h);
    if (status == PL_NO_STEP)
        fail("the step is not above 0");
    if (status == PL_NO_RATE)
        fail("with these values a load's frequency is below 0");
    if (status == PL_SINGULAR)
        fail("with these values the mass matrix has no inverse");
    if (status != 0)
        fail("with these values the numbers of the step are not finite");
}

static void run(double end, int count, char **text, const char *program)
{
    void *state = need(malloc(model->size));
    real *out = (real *)need(malloc(sizeof *out * (size_t)(model->outputs + 1)));
    real *u = (real *)need(malloc(sizeof *u * (size_t)(model->inputs + 1)));
    real *params = (real *)need(malloc(sizeof *params * (size_t)(model->params + 1)));
    samples in = {NULL, 256, 0, 0, 0};
    real h;
    uint64_t k, steps;

    in.line = (char *)need(malloc(in.room));
    read_values(count, text, program, params, &h);
    model->init(state);
    if (count > 0)
        retune(state, params, h);
    steps = steps_until(end, (double)h);
    if (model->inputs > 0 && steps > 0)
        read_header(&in);
    print_header();
    print_row(state, out);
    for (k = 0; k < steps; k++) {
        if (model->inputs > 0)
            read_sample(&in, u);
        model->step(state, model->inputs > 0 ? u : NULL);
        check_status(state);
        print_row(state, out);
    }
    free(in.line);
    free(params);
    free(u);
    free(out);
    free(state);
}

int main(int argc, char **argv)
{
    const double end = end_of_run(argc, argv);
    run(end, argc - 2, argv + 2, argv[0]);
    if (fclose(stdout) != 0)
        fail("cannot write to standard output");
    return 0;
}
