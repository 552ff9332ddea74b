/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words with a meaning of their own, and names that resemble a misspelt one. */
#include "read/read.h"

#include <string.h>
#include <strings.h>

static const char *const function_names[] = {
	"",
#define REAL_FUNCTION(NAME, name, argument, value, low, high) #name,
#include "read/functions.def"
#undef REAL_FUNCTION
	"atan2", "abs", "sgn", "min", "max", "deadzone", "clip", "table", "friction", "", "sum", "cumsum", "dot"
};

/* Statements; what the language has else */
static const char words[] =
	" model param coord init let input output matrix mass spring damper force step scheme operator tunable"
	" t pi at hold first between on ground ";

/* C99 to C23, C++17 and C++20 keywords and alternative tokens */
static const char keywords[] =
	" alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class"
	" co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype"
	" default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline"
	" int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public"
	" register reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast"
	" struct switch template this thread_local throw true try typedef typeid typename typeof typeof_unqual union"
	" unsigned using virtual void volatile wchar_t while xor xor_eq ";

/* Names of C11 and POSIX that a host's headers declare or its linker finds, which a model's type could meet. Not
 * listed, since rules say it (is_of_library): sinf and sinl beside sin, size_t and all that ends in _t, families that a
 * prefix names. */
static const char *const library[] = {
	" a64l abort abs accept access acct acos acosh alarm aligned_alloc alloca arc4random arc4random_buf"
	" arc4random_uniform asctime asctime_r asin asinh assert at_quick_exit atan atan2 atanh atexit atof atoi atol"
	" atoll basename bcmp bcopy bind brk bsearch btowc bzero c16rtomb c32rtomb cabs cacos cacosh call_once calloc"
	" carg casin casinh catan catanh cbrt ccos ccosh ceil cexp chdir chown chroot cimag clearenv clearerr"
	" clearerr_unlocked clock clock_getcpuclockid clock_getres clock_gettime clock_nanosleep clock_settime clog"
	" close closefrom CMPLX CMPLXF CMPLXL cnd_broadcast cnd_destroy cnd_init cnd_signal cnd_timedwait cnd_wait"
	" complex confstr conj connect copysign cos cosh cpow cproj creal creat csin csinh csqrt ctan ctanh ctermid"
	" ctime ctime_r daemon daylight DECIMAL_DIG difftime DIR dirname div dlclose dlerror dlopen dlsym dprintf"
	" drand48 drand48_r drem dup dup2 duplocale dysize ecvt ecvt_r endusershell environ epoll_create erand48"
	" erand48_r erf erfc errno eventfd execl execle execlp execv execve execvp exit exp exp2 explicit_bzero expm1"
	" fabs faccessat fattach fchdir fchown fchownat fclose fcntl fcvt fcvt_r fd_mask fdatasync fdim fdopen"
	" feclearexcept fegetenv fegetexceptflag fegetround feholdexcept feof feof_unlocked feraiseexcept ferror"
	" ferror_unlocked fesetenv fesetexceptflag fesetround fetestexcept feupdateenv fexecve fflush fflush_unlocked"
	" ffs fgetc fgetc_unlocked fgetpos fgets fgetwc fgetws FILE fileno fileno_unlocked finite flock flockfile"
	" floor fma fmax fmemopen fmin fmod fnmatch fopen fork fpathconf fpclassify fprintf fputc fputc_unlocked fputs"
	" fputwc fputws fread fread_unlocked free freelocale freopen frexp fscanf fseek fseeko fsetpos fsync ftell"
	" ftello ftok ftruncate ftrylockfile ftw funlockfile fwide fwprintf fwrite fwrite_unlocked fwscanf gamma gcvt"
	" getaddrinfo getc getc_unlocked getchar getchar_unlocked getcwd getdelim getdomainname getdtablesize getegid"
	" getentropy getenv geteuid getgid getgroups gethostid gethostname getitimer getline getloadavg getlogin"
	" getlogin_r getmsg getopt getopt_long getpagesize getpass getpgid getpgrp getpid getppid getrlimit getrusage"
	" gets getsid getsockopt getsubopt gettimeofday getuid getusershell getw getwc getwchar getwd glob globfree"
	" gmtime gmtime_r gsignal hcreate hdestroy hsearch htonl htons hypot iconv ilogb imaginary imaxabs imaxdiv"
	" index inet_addr initstate initstate_r insque ioctl isalnum isalnum_l isalpha isalpha_l isascii isatty"
	" isblank isblank_l iscntrl iscntrl_l isdigit isdigit_l isfinite isgraph isgraph_l isgreater isgreaterequal"
	" isinf isless islessequal islessgreater islower islower_l isnan isnormal isprint isprint_l ispunct ispunct_l"
	" isspace isspace_l isunordered isupper isupper_l iswalnum iswalnum_l iswalpha iswalpha_l iswblank iswblank_l"
	" iswcntrl iswcntrl_l iswctype iswctype_l iswdigit iswdigit_l iswgraph iswgraph_l iswlower iswlower_l iswprint"
	" iswprint_l iswpunct iswpunct_l iswspace iswspace_l iswupper iswupper_l iswxdigit iswxdigit_l isxdigit"
	" isxdigit_l j0 j1 jn jrand48 jrand48_r kill killpg l64a labs lchown lcong48 lcong48_r ldexp ldiv lfind lgamma"
	" lgamma_r lgammaf_r lgammal_r link linkat listen llabs lldiv llrint llround localeconv localtime localtime_r"
	" lockf log log10 log1p log2 logb longjmp lrand48 lrand48_r lrint lround lsearch lseek main malloc"
	" math_errhandling mblen mbrlen mbrtoc16 mbrtoc32 mbrtowc mbsinit mbsnrtowcs mbsrtowcs mbstowcs mbtowc memccpy"
	" memchr memcmp memcpy memmove memset mkdir mkdtemp mkfifo mknod mkstemp mkstemps mktemp mktime mlock mmap"
	" modf mount mprotect mrand48 mrand48_r msgctl msgget msgrcv msgsnd msync mtx_destroy mtx_init mtx_lock"
	" mtx_timedlock mtx_trylock mtx_unlock munmap nan nanosleep nearbyint newlocale nextafter nexttoward nftw ",
	" nftw64 nice noreturn nrand48 nrand48_r ntohl ntohs offsetof on_exit once_flag open open_memstream"
	" open_wmemstream openat opendir openlog optarg opterr optind optopt pathconf pause pclose perror pipe poll"
	" popen pow pread printf profil pselect psiginfo psignal putc putc_unlocked putchar putchar_unlocked putenv"
	" putmsg puts putw putwc putwchar pwrite qecvt qecvt_r qfcvt qfcvt_r qgcvt qsort quick_exit raise rand rand_r"
	" random random_r read readdir readlink readlinkat readv realloc reallocarray realpath reboot recv recvfrom"
	" recvmsg regcomp regerror regexec regfree remainder remove remque remquo rename renameat revoke rewind"
	" rewinddir rindex rint rmdir round rpmatch sbrk scalb scalbln scalbn scandir scanf sched_get_priority_max"
	" sched_get_priority_min sched_getparam sched_getscheduler sched_rr_get_interval sched_setparam"
	" sched_setscheduler sched_yield seed48 seed48_r seekdir select sem_close sem_destroy sem_getvalue sem_init"
	" sem_open sem_post sem_timedwait sem_trywait sem_unlink sem_wait semctl semget semop send sendfile sendmsg"
	" sendto setbuf setbuffer setdomainname setegid setenv seteuid setgid sethostid sethostname setitimer setjmp"
	" setlinebuf setlocale setlogin setpgid setpgrp setpriority setregid setreuid setrlimit setsid setsockopt"
	" setstate setstate_r setuid setusershell setvbuf shmat shmctl shmdt shmget shutdown sigaction sigaddset"
	" sigaltstack sigblock sigdelset sigemptyset sigfillset siggetmask siginterrupt sigismember siglongjmp sigmask"
	" signal signalfd signbit signgam significand sigpending sigprocmask sigqueue sigreturn sigsetjmp sigsetmask"
	" sigstack sigsuspend sigtimedwait sigwait sigwaitinfo sin sinh sleep snprintf socket socketpair splice"
	" sprintf sqrt srand srand48 srand48_r srandom srandom_r sscanf ssignal stat statvfs std stderr stdin stdout"
	" stime stpcpy stpncpy strcasecmp strcasecmp_l strcat strchr strcmp strcoll strcoll_l strcpy strcspn strdup"
	" strerror strerror_l strerror_r strftime strftime_l strlcat strlcpy strlen strncasecmp strncasecmp_l strncat"
	" strncmp strncpy strndup strnlen strpbrk strrchr strsep strsignal strspn strstr strtod strtof strtoimax"
	" strtok strtok_r strtol strtold strtoq strtoul strtoumax strtouq strxfrm strxfrm_l swprintf swscanf symlink"
	" symlinkat sync syscall sysconf syslog system tan tanh tcgetattr tcgetpgrp tcsetattr tcsetpgrp tdelete tee"
	" telldir tempnam tfind tgamma thrd_create thrd_current thrd_detach thrd_equal thrd_exit thrd_join thrd_sleep"
	" thrd_yield time timegm timelocal timer_create timer_delete timer_getoverrun timer_gettime timer_settime"
	" times timespec_get timezone tmpfile tmpnam tmpnam_r toascii tolower tolower_l toupper toupper_l towctrans"
	" towctrans_l towlower towlower_l towupper towupper_l trunc truncate tsearch tss_create tss_delete tss_get"
	" tss_set ttyname ttyname_r ttyslot twalk tzname tzset u_char u_int u_long u_short ualarm uint ulong umask"
	" umount uname ungetc ungetwc unlink unlinkat unsetenv uselocale ushort usleep ustat utime utimes va_arg"
	" va_copy va_end va_list va_start valloc vdprintf vfork vfprintf vfscanf vfwprintf vfwscanf vhangup vmsplice"
	" vprintf vscanf vsnprintf vsprintf vsscanf vswprintf vswscanf vwprintf vwscanf wait waitid waitpid wcpcpy"
	" wcpncpy wcrtomb wcscasecmp wcscasecmp_l wcscat wcschr wcscmp wcscoll wcscoll_l wcscpy wcscspn wcsdup"
	" wcsftime wcslen wcsncasecmp wcsncasecmp_l wcsncat wcsncmp wcsncpy wcsnlen wcsnrtombs wcspbrk wcsrchr"
	" wcsrtombs wcsspn wcsstr wcstod wcstof wcstoimax wcstok wcstol wcstold wcstombs wcstoul wcstoumax wcsxfrm"
	" wcsxfrm_l wctob wctomb wctrans wctrans_l wctype wctype_l WEOF wmemchr wmemcmp wmemcpy wmemmove wmemset"
	" wordexp wprintf write writev wscanf y0 y1 yn "
};

/* Of a library's functions NAME_init, NAME_set, ..., which a model of that name would have too: sem_init, mtx_init,
 * fts_set. tests/errors/names.sh compares with the headers that it finds. */
static const char families[] =
	" aio aio_idle argp_err_exit atomic cnd envz fanotify fd fts fts64 inet6_opt inet6_option inet6_rth inotify"
	" key_secretkey_is mtx name_to_handle obstack open_by_handle pkey pmap sem si sockaddr svc timespec tss ";
static const char *const family_prefixes[] = { "atomic_", "posix_", "pthread_" };

static bool listed(const char *name, const char *list)
{
	return strstr(list, format(" %s ", name));
}

static bool is_declared(const char *name)
{
	return listed(name, library[0]) || listed(name, library[1]);
}

/* sinf, powl; pid_t; pthread_attr */
static bool is_of_library(const char *name)
{
	size_t length = strlen(name);
	char last = name[length - 1];
	if (is_declared(name) || listed(name, families) ||
	    ((last == 'f' || last == 'l') && is_declared(format("%.*s", (int)length - 1, name))))
		return true;
	for (size_t i = 0; i < sizeof family_prefixes / sizeof *family_prefixes; i++)
		if (strncmp(name, family_prefixes[i], strlen(family_prefixes[i])) == 0)
			return true;
	return length > 2 && strcmp(name + length - 2, "_t") == 0;
}

/* The same for names that are one in C: front.body, front_body */
size_t name_hash(const char *name)
{
	size_t hash = 0;
	for (; *name; name++)
		hash = (hash ^ (unsigned char)(*name == '.' ? '_' : *name)) * 0x9e3779b97f4a7c15u;
	return hash >> 20;
}

const char *function_name(enum function function)
{
	return function_names[function];
}

enum function function_of(const char *name)
{
	for (int f = FN_SIN; f <= FN_FRICTION; f++)
		if (strcmp(name, function_names[f]) == 0)
			return (enum function)f;
	return FN_NONE;
}

enum function vector_function_of(const char *name)
{
	for (int f = FN_SUM; f <= FN_DOT; f++)
		if (strcmp(name, function_names[f]) == 0)
			return (enum function)f;
	return FN_NONE;
}

bool is_reserved(const char *name)
{
	/* friction may be a name: the function has a bracket behind it */
	enum function function = function_of(name);
	return listed(name, words) || listed(name, keywords) || (function != FN_NONE && function != FN_FRICTION);
}

const char *prefix_objection(const char *name)
{
	if (strcasecmp(name, "pl") == 0 || strncmp(name, "pl_", 3) == 0 || strcasecmp(name, "plrt") == 0)
		return "is kept for the runtime";
	if (is_of_library(name))
		return "is a name of the C library";
	if (is_reserved(name))
		return "is a reserved word";
	if (name[0] == '_')
		return "starts with _, which C keeps for itself,";
	if (may_be_macro(name))
		return "is or may be a macro of C";
	return NULL;
}

static int least(int a, int b, int c)
{
	int ab = a < b ? a : b;
	return ab < c ? ab : c;
}

/* Number of letters to insert, remove, replace or swap with their neighbour to make `a` into `b` (Damerau), if it is
 * below `limit`; else it is no less. */
static int edit_distance(const char *a, const char *b, int limit)
{
	int m = (int)strlen(a), n = (int)strlen(b);
	if (m > 64 || n > 64 || m - n >= limit || n - m >= limit)
		return 64;
	int d[65][65], before = 0, row = 0;     /* the least of the last two rows */
	for (int i = 0; i <= m; i++) {
		if (i > 1 && before >= limit && row >= limit)
			return 64;
		before = row;
		row = 64;
		for (int j = 0; j <= n; j++) {
			if (i == 0 || j == 0) {
				d[i][j] = i + j;
				row = d[i][j] < row ? d[i][j] : row;
				continue;
			}
			int replace = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
			d[i][j] = least(d[i - 1][j] + 1, d[i][j - 1] + 1, replace);
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
			    d[i - 2][j - 2] + 1 < d[i][j])
				d[i][j] = d[i - 2][j - 2] + 1;
			row = d[i][j] < row ? d[i][j] : row;
		}
	}
	return d[m][n];
}

const char *nearest_name(const char *name, int count, const char *const *known)
{
	const char *best = NULL;
	int distance = (int)strlen(name) <= 2 ? 2 : 3;
	for (int i = 0; i < count; i++) {
		int d = edit_distance(name, known[i], distance);
		if (d > 0 && strcasecmp(name, known[i]) == 0)
			return known[i];
		if (d > 0 && d < distance && d < (int)strlen(name)) {
			best = known[i];
			distance = d;
		}
	}
	return best;
}

const char *spec_suggestion(const struct spec *spec, const char *name)
{
	int count = 0, room = FN_FRICTION;
	for (const struct symbol *s = spec->first; s; s = s->next)
		room++;
	const char **known = ARRAY(const char *, room);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind != SYMBOL_OUTPUT)
			known[count++] = s->name;
	for (int f = FN_SIN; f <= FN_FRICTION; f++)
		known[count++] = function_names[f];
	const char *best = nearest_name(name, count, known);
	return best ? format("did you mean '%s'?", best) : NULL;
}

/* size_t, double_t, uint_fast16_t: types of the headers that generated code includes, which a local would hide */
static bool is_type(const char *name)
{
	static const char types[] =
		" size_t ssize_t ptrdiff_t wchar_t max_align_t nullptr_t float_t double_t ";
	size_t length = strlen(name);
	if (listed(name, types))
		return true;
	return length > 5 && strcmp(name + length - 2, "_t") == 0 &&
	       (strncmp(name, "int", 3) == 0 || strncmp(name, "uint", 4) == 0);
}

/* Macros of the headers that generated code may include, and of compilers in their GNU modes; types likewise */
bool may_be_macro(const char *name)
{
	static const char macros[] =
		" NULL NAN INFINITY I unix linux i386 vax sun OVERFLOW UNDERFLOW DOMAIN SING PLOSS TLOSS EOF BUFSIZ"
		" WCHAR_MAX WCHAR_MIN math_errhandling signgam errno stdin stdout stderr complex imaginary assert ";
	if (listed(name, macros))
		return true;
	size_t length = strlen(name);
	return is_type(name) || name[0] == '_' || strncmp(name, "M_", 2) == 0 || strncmp(name, "FP_", 3) == 0 ||
	       strncmp(name, "HUGE", 4) == 0 || strncmp(name, "MATH_", 5) == 0 || strncmp(name, "INT", 3) == 0 ||
	       strncmp(name, "UINT", 4) == 0 || strncmp(name, "PL", 2) == 0 || strncmp(name, "pl_", 3) == 0 ||
	       strncmp(name, "SIZE_", 5) == 0 || (length > 4 && strcmp(name + length - 4, "_MAX") == 0) ||
	       (length > 4 && strcmp(name + length - 4, "_MIN") == 0);
}
