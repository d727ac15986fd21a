!> Wall-clock timers by phase and counters of the expensive operations.
module lopin_clock
   use lopin_kinds, only : wp, lk
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: clock_type, counter_type, phase_names, nphase, phase, keep_counter

   integer, parameter :: nphase = 10

   !> Phases in the order in which a run meets them.
   type :: phases
      integer :: read = 1, model = 2, search = 3, assemble = 4, analyse = 5, factorise = 6
      integer :: contact = 7, solve = 8, check = 9, output = 10
   end type phases
   type(phases), parameter :: phase = phases()
   character(len=*), parameter :: phase_names(nphase) = [character(len=9) :: 'read', 'model', &
      & 'search', 'assemble', 'analyse', 'factorise', 'contact', 'solve', 'check', 'output']

   !> How often the expensive things were done.
   type :: counter_type
      integer :: factorisations = 0
      integer :: back_solves = 0       !! forward plus backward pass over the whole factor
      integer :: iterations = 0        !! contact iterations
      integer :: augmentations = 0
      ! of the nonlinear path, contacts that are searched on the present shape
      integer(lk) :: queries = 0       !! points that asked a surface
      integer(lk) :: projections = 0   !! closest points of one facet
      integer(lk) :: boxes = 0         !! distances to boxes
   end type counter_type

   type :: clock_type
      real(wp) :: seconds(nphase) = 0.0_wp
      integer(lk) :: started = 0
   contains
      procedure :: start
      procedure :: stop_in
      procedure :: total
   end type clock_type

contains

   !> Counts to a stream or back.
   subroutine keep_counter(self, stream)
      type(counter_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%factorisations)
      call stream%pass(self%back_solves)
      call stream%pass(self%iterations)
      call stream%pass(self%augmentations)
      call stream%pass(self%queries)
      call stream%pass(self%projections)
      call stream%pass(self%boxes)
   end subroutine keep_counter

   subroutine start(self)
      class(clock_type), intent(inout) :: self
      call system_clock(self%started)
   end subroutine start

   !> Add the time since the last `start` or `stop_in` to a phase, and start again.
   subroutine stop_in(self, which)
      class(clock_type), intent(inout) :: self
      integer, intent(in) :: which
      integer(lk) :: now, rate

      call system_clock(now, rate)
      self%seconds(which) = self%seconds(which) + real(now - self%started, wp)/real(rate, wp)
      self%started = now
   end subroutine stop_in

   pure real(wp) function total(self)
      class(clock_type), intent(in) :: self
      total = sum(self%seconds)
   end function total
end module lopin_clock
