"""Words of seven languages that control how a type is read, and the built-in types."""

FALLS_AWAY = frozenset(
    (
        "const volatile typename struct class enum union static inline virtual explicit "
        "constexpr consteval constinit friend extern register thread_local mutable "
        "restrict __restrict __restrict__ _Noreturn noexcept public protected private "
        "abstract final synchronized native default strictfp mut dyn ref unsafe signed in "
        "out"
    ).split()
)
INTEGER_WORDS = frozenset({"unsigned", "long", "short", "int", "char", "double", "signed"})
WRAPPERS = frozenset(
    (
        "shared_ptr unique_ptr weak_ptr optional expected future shared_future "
        "reference_wrapper Box Rc Arc Option Result Optional Future CompletableFuture "
        "Supplier Awaitable Coroutine Annotated Cow Final ClassVar Required NotRequired "
        "not_null observer_ptr intrusive_ptr Pin"
    ).split()
)
STREAMS = frozenset(
    (
        "Iterator Iterable AsyncIterator AsyncIterable Generator AsyncGenerator Stream "
        "Publisher Flux Mono Observable Flowable Receiver Sender Channel channel "
        "generator Flow IntoIterator BlockingQueue Queue Subscription Chan Flow"
    ).split()
)
SEQUENCES = frozenset(
    (
        "vector list set deque span array forward_list multiset unordered_set valarray "
        "initializer_list Vec VecDeque LinkedList HashSet BTreeSet List Set ArrayList "
        "Collection Sequence MutableSequence FrozenSet frozenset Deque tuple_list"
    ).split()
)
MAPS = frozenset(
    (
        "map unordered_map multimap flat_map dict Dict Map HashMap BTreeMap TreeMap "
        "LinkedHashMap ConcurrentHashMap Mapping MutableMapping OrderedDict defaultdict"
    ).split()
)
CALLBACKS = frozenset(
    (
        "function move_only_function Callable Fn FnMut FnOnce fn func Function BiFunction "
        "Consumer BiConsumer Predicate Runnable UnaryOperator BinaryOperator lambda"
    ).split()
)
UNKNOWN = frozenset({"auto", "var", "Any", "object", "Object", "interface{}", "any"})
NOTHING = frozenset({"void", "None", "NoneType", "Void", "!", "()", "error"})
ROS_FOLDERS = frozenset({"msg", "srv", "action"})
POINTERS = ("SharedPtr", "ConstSharedPtr", "UniquePtr", "WeakPtr", "Ptr", "ConstPtr")
NOT_INPUTS = frozenset(
    (
        "function Time TimePoint time_point Duration duration milliseconds seconds "
        "microseconds nanoseconds minutes hours Instant SystemTime LocalDateTime datetime "
        "timedelta Timestamp timespec timeval time_t Context CancellationToken"
    ).split()
)
BUILTIN = frozenset(
    (
        "bool boolean Boolean char byte short int long float double size_t ssize_t str "
        "String string unsigned usize isize u8 u16 u32 u64 u128 i8 i16 i32 i64 i128 f32 "
        "f64 int8 int16 int32 int64 uint8 uint16 uint32 uint64 uint float32 float64 rune "
        "complex bytes Integer Long Float Double int8_t int16_t int32_t int64_t uint8_t "
        "uint16_t uint32_t uint64_t std::string"
    ).split()
)
ARITHMETIC = BUILTIN - {"str", "String", "string", "std::string", "bytes", "char"}
