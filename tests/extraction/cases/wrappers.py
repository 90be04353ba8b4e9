class A:
    """Docstring.

    # @module_start
    """

    # @module_start
    # @module_name A
    @staticmethod
    # @DataOut RequestWhenReady -- between decorator and function
    @cache
    async def latest(
        self: "A",
        grid: "np.ndarray",  # :the grid
        goal: typing.Union[Pose, None],
        start: typing.Optional["Pose"] = None,
        *scans: msgs.msg.Scan,
        log: Callable[[str], None] = print,
        when: datetime.datetime = None,
        untyped=3,
        **rest,
    ) -> AsyncIterator[tuple[Pose, ...]]:
        yield ()

    # @DataOut RequestWhenReady
    class Inner: ...

    # @DataOut RequestWhenReady
    x = lambda s: s

    # @DataOut RequestWhenReady
    def generic[T: (int, str)](x: T) -> dict[str, T]: ...

    # @DataOut RequestWhenReady
    def broken(x: Scan -> Map:
        pass

    # @DataIn
    def show(image: Image) -> None: ...
    # @module_end
