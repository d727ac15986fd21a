!> What Python sees: the only file that f2py reads, and it knows only plain arguments.
!>
!> Arrays are (component, item); increments and rows count from 1; `code` is 0 or an exit code of
!> the executable. Python calls these through `_bridge.py` and nothing else.
module lopin_api
   use lopin_probes, only : cell_functions, facet_projection, tool_gaps, skyline_solution, &
      & contact_forces, moduli, element_stiffness
   use lopin_probes_friction_set, only : friction_increment
   use lopin_probes_friction, only : friction_tractions
   use lopin_session, only : session_type, deck_text_type, new_session, keep_session, &
      & forget_session, session_text, session_real, session_integer, advance_session, &
      & end_session, session_state, session_tool_feet, forget_workspace_of
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: run_deck, check_deck, close_session
   public :: open_run, advance, end_run, state_length, get_state, forget_workspace, tool_feet
   public :: text_length, copy_text, result_shape, get_real, get_integer
   public :: probe_shape, probe_project, probe_tool_gap, probe_skyline_solve, probe_contact
   public :: probe_hooke, probe_stiffness, probe_friction, probe_friction_increment, echo

contains

   !> Solve a deck; the results stay in memory until `close_session`.
   subroutine run_deck(text, name, folder, output, options, handle, code)
      character(len=*), intent(in) :: text      !! the whole deck
      character(len=*), intent(in) :: name      !! as in messages, such as press.inp
      character(len=*), intent(in) :: folder    !! of its includes
      character(len=*), intent(in) :: output    !! folder of the result files; '' for none
      character(len=*), intent(in) :: options   !! lines such as solver=umfpack
      integer, intent(out) :: handle, code
      !f2py threadsafe
      logical :: more

      call open_session(text, name, folder, output, options, .true., handle, code)
      more = code == 0
      do while (more)
         call advance_session(handle, .false., more, code)
      end do
      call end_session(handle)
   end subroutine run_deck

   !> Open a run: `advance` goes to its increments, `end_run` ends it, `close_session` forgets it.
   subroutine open_run(text, name, folder, output, options, state, handle, code)
      character(len=*), intent(in) :: text, name, folder, output, options   !! as of `run_deck`
      integer(kind=1), intent(in) :: state(:)   !! from `get_state` of the same deck; empty: none
      integer, intent(out) :: handle, code
      !f2py threadsafe
      type(session_type), pointer :: session
      type(stream_type) :: stream

      allocate (session)
      if (size(state) > 0) then
         stream%bytes = state
         stream%n = size(state)
         call new_session(session, deck_text_type(text, name, folder), output, options, .true., &
            & stream)
      else
         call new_session(session, deck_text_type(text, name, folder), output, options, .true.)
      end if
      code = session%code
      call keep_session(session, handle)
   end subroutine open_run

   !> The next accepted increment; at the end of a run, and after an error, `more` is 0 and it is
   !> ended. An interrupt leaves it open at the last accepted increment.
   subroutine advance(handle, more, code)
      integer, intent(in) :: handle
      integer, intent(out) :: more, code
      !f2py threadsafe
      logical :: accepted

      call advance_session(handle, .true., accepted, code)
      more = merge(1, 0, accepted)
   end subroutine advance

   !> End a run where it stands.
   subroutine end_run(handle)
      integer, intent(in) :: handle
      !f2py threadsafe
      call end_session(handle)
   end subroutine end_run

   !> Bytes of the state between two increments; 0 if the run is not open.
   subroutine state_length(handle, n)
      integer, intent(in) :: handle
      integer, intent(out) :: n
      type(stream_type) :: stream

      call session_state(handle, stream)
      n = int(stream%n)
   end subroutine state_length

   !> Closest points of the tool of a pair where it stands now, of an open run: gap, how far beyond
   !> an open end, the point, its normal. `code` 2: the pair has no analytic tool.
   subroutine tool_feet(handle, pair, points, ndim, npoint, foot, code)
      integer, intent(in) :: handle, pair       !! pair from 1
      integer, intent(in) :: ndim, npoint
      double precision, intent(in) :: points(ndim, npoint)
      double precision, intent(out) :: foot(2 + 2*ndim, npoint)
      integer, intent(out) :: code
      logical :: found

      call session_tool_feet(handle, pair, points, foot, found)
      code = merge(0, 2, found)
   end subroutine tool_feet

   !> Make all that is not state again from the model and the state, between two increments.
   subroutine forget_workspace(handle, code)
      integer, intent(in) :: handle
      integer, intent(out) :: code
      !f2py threadsafe

      call forget_workspace_of(handle, code)
   end subroutine forget_workspace

   !> What an open run holds between two increments, byte by byte.
   subroutine get_state(handle, n, state)
      integer, intent(in) :: handle
      integer, intent(in) :: n                  !! from `state_length`
      integer(kind=1), intent(out) :: state(n)
      type(stream_type) :: stream

      call session_state(handle, stream)
      state = stream%bytes(:n)
   end subroutine get_state

   !> Read and check a deck without solving it.
   subroutine check_deck(text, name, folder, options, handle, code)
      character(len=*), intent(in) :: text, name, folder, options
      integer, intent(out) :: handle, code
      !f2py threadsafe
      call open_session(text, name, folder, '', options, .false., handle, code)
   end subroutine check_deck

   subroutine open_session(text, name, folder, output, options, begin, handle, code)
      character(len=*), intent(in) :: text, name, folder, output, options
      logical, intent(in) :: begin
      integer, intent(out) :: handle, code
      type(session_type), pointer :: session

      allocate (session)
      call new_session(session, deck_text_type(text, name, folder), output, options, begin)
      code = session%code
      call keep_session(session, handle)
   end subroutine open_session

   !> Forget a run and its results.
   subroutine close_session(handle)
      integer, intent(in) :: handle
      call forget_session(handle)
   end subroutine close_session

   !> Length of a text: diagnostics, summary, names; keywords of any handle.
   subroutine text_length(handle, what, length)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: what
      integer, intent(out) :: length
      !f2py threadsafe
      character(len=:), allocatable :: text

      call session_text(handle, what, text)
      length = len(text)
   end subroutine text_length

   !> The text itself, letter by letter.
   subroutine copy_text(handle, what, length, text)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: what
      integer, intent(in) :: length             !! from `text_length`
      character(len=1), intent(out) :: text(length)
      !f2py threadsafe
      character(len=:), allocatable :: whole
      integer :: i

      call session_text(handle, what, whole)
      text = ' '
      do i = 1, min(length, len(whole))
         text(i) = whole(i:i)
      end do
   end subroutine copy_text

   !> Components and items of a result, and whether it is of integers.
   subroutine result_shape(handle, name, index, n, m, is_integer, code)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: name
      integer, intent(in) :: index              !! increment from 1
      integer, intent(out) :: n, m, is_integer, code
      double precision, allocatable :: reals(:, :)
      integer, allocatable :: integers(:, :)

      n = 0
      m = 0
      is_integer = 0
      code = 0
      call session_real(handle, name, index, reals)
      call session_integer(handle, name, index, integers)
      if (allocated(reals)) then
         n = size(reals, 1)
         m = size(reals, 2)
      else if (allocated(integers)) then
         n = size(integers, 1)
         m = size(integers, 2)
         is_integer = 1
      else
         code = 2
      end if
   end subroutine result_shape

   !> A result of real numbers; `code` is 2 if there is none of this name and shape.
   subroutine get_real(handle, name, index, n, m, values, code)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: name
      integer, intent(in) :: index, n, m        !! from `result_shape`
      double precision, intent(out) :: values(n, m)
      integer, intent(out) :: code
      double precision, allocatable :: found(:, :)

      values = 0
      code = 2
      call session_real(handle, name, index, found)
      if (.not. allocated(found)) return
      if (any(shape(found) /= [n, m])) return
      values = found
      code = 0
   end subroutine get_real

   !> The same of whole numbers.
   subroutine get_integer(handle, name, index, n, m, values, code)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: name
      integer, intent(in) :: index, n, m        !! from `result_shape`
      integer, intent(out) :: values(n, m)
      integer, intent(out) :: code
      integer, allocatable :: found(:, :)

      values = 0
      code = 2
      call session_integer(handle, name, index, found)
      if (.not. allocated(found)) return
      if (any(shape(found) /= [n, m])) return
      values = found
      code = 0
   end subroutine get_integer

   !> What was sent, unchanged to the last bit.
   subroutine echo(x, y, n)
      integer, intent(in) :: n
      double precision, intent(in) :: x(n)
      double precision, intent(out) :: y(n)
      y = x
   end subroutine echo

   !> Shape functions of a cell at a parametric point, and their slopes.
   subroutine probe_shape(cell, xi, nnode, ndim, values, slopes, code)
      character(len=*), intent(in) :: cell
      integer, intent(in) :: nnode, ndim
      double precision, intent(in) :: xi(ndim)
      double precision, intent(out) :: values(nnode), slopes(ndim, nnode)
      integer, intent(out) :: code
      call cell_functions(cell, xi, values, slopes, code)
   end subroutine probe_shape

   !> The closest point of one facet.
   subroutine probe_project(cell, x, point, nnode, ndim, foot, code)
      character(len=*), intent(in) :: cell
      integer, intent(in) :: nnode, ndim
      double precision, intent(in) :: x(ndim, nnode), point(ndim)
      double precision, intent(out) :: foot(2*ndim)   !! xi (ndim - 1), gap, normal (ndim)
      integer, intent(out) :: code
      call facet_projection(cell, x, point, foot(:ndim - 1), foot(ndim), foot(ndim + 1:), code)
   end subroutine probe_project

   !> Gaps and normals of points to a rigid tool; `data` as of `tool_gaps`.
   subroutine probe_tool_gap(kind, data, points, ndata, ndim, npoint, foot, code)
      character(len=*), intent(in) :: kind
      integer, intent(in) :: ndata, ndim, npoint
      double precision, intent(in) :: data(ndata), points(ndim, npoint)
      double precision, intent(out) :: foot(ndim + 1, npoint)   !! gap, normal
      integer, intent(out) :: code
      call tool_gaps(kind, data, points, foot(1, :), foot(2:, :), code)
   end subroutine probe_tool_gap

   !> Solve with the skyline solver; lower triangle by columns, from 1.
   subroutine probe_skyline_solve(pointer, row, value, b, n, nnz, x, code)
      integer, intent(in) :: n, nnz
      integer, intent(in) :: pointer(n + 1), row(nnz)
      double precision, intent(in) :: value(nnz), b(n)
      double precision, intent(out) :: x(n)
      integer, intent(out) :: code
      !f2py threadsafe
      call skyline_solution(pointer, row, value, b, x, code)
   end subroutine probe_skyline_solve

   !> Contact of a body known by its compliance; see `contact_forces`.
   subroutine probe_contact(compliance, gap, method, alpha, n, force, iterations, code)
      integer, intent(in) :: n
      double precision, intent(in) :: compliance(n, n), gap(n), alpha(n)
      character(len=*), intent(in) :: method
      double precision, intent(out) :: force(n)
      integer, intent(out) :: iterations, code
      !f2py threadsafe
      call contact_forces(compliance, gap, method, alpha, force, iterations, code)
   end subroutine probe_contact

   !> Hooke's matrix of a kind: 4 x 4 in the plane, 6 x 6 of a solid.
   subroutine probe_hooke(kind, young, poisson, n, d, code)
      character(len=*), intent(in) :: kind
      double precision, intent(in) :: young, poisson
      integer, intent(in) :: n
      double precision, intent(out) :: d(n, n)
      integer, intent(out) :: code
      call moduli(kind, young, poisson, d, code)
   end subroutine probe_hooke

   !> Stiffness of an element of the deck language.
   subroutine probe_stiffness(word, formulation, x, elastic, nnode, ndim, k, code)
      character(len=*), intent(in) :: word, formulation
      integer, intent(in) :: nnode, ndim
      double precision, intent(in) :: x(ndim, nnode)
      double precision, intent(in) :: elastic(3)   !! Young's modulus, Poisson's ratio, thickness
      double precision, intent(out) :: k(ndim*nnode, ndim*nnode)
      integer, intent(out) :: code
      call element_stiffness(word, formulation, x, elastic(:2), elastic(3), k, code)
   end subroutine probe_stiffness

   !> Tractions of a law of friction and their slopes at many points.
   subroutine probe_friction(law, regularization, data, point, n, answer, code)
      character(len=*), intent(in) :: law, regularization
      integer, intent(in) :: n
      double precision, intent(in) :: data(14), point(2, n)   !! as of `friction_tractions`
      double precision, intent(out) :: answer(3, n)
      integer, intent(out) :: code
      call friction_tractions(law, regularization, data, point, answer, code)
   end subroutine probe_friction

   !> One increment of Coulomb's friction at points in the plane.
   subroutine probe_friction_increment(compliance, law, switches, before, n, after, info, code)
      integer, intent(in) :: n
      double precision, intent(in) :: compliance(n, n), law(3), before(n, 3)
      integer, intent(in) :: switches(4)
      double precision, intent(out) :: after(n, 2), info(7)   !! as of `friction_increment`
      integer, intent(out) :: code
      !f2py threadsafe
      call friction_increment(compliance, law, switches, before, after, info, code)
   end subroutine probe_friction_increment
end module lopin_api
