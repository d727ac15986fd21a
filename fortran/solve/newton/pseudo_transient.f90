!> Pseudo-transient continuation, used where Newton finds no next equilibrium.
!>
!> A path of equilibria may turn back where a node leaves a tool: the states beyond are far from the
!> last one however small the increment is. A real part jumps there. The motion D dx/dt = -r, taken
!> by implicit steps from the accepted state, follows such a jump, and Newton ends it: what is
!> accepted is an equilibrium like any other (pseudo-transient continuation, Kelley and Keyes, SIAM
!> J. Numer. Anal. 35, 1998, 508-523). D is the elastic stiffness of the accepted shape, so that
!> long waves move as fast as short ones, and pseudo-time is a number without a unit. A share of
!> mass is added, which lets a free body move by a facet in unit time under the forces about.
module lopin_pseudo_transient
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_interrupt, only : answer_interrupt
   use lopin_mesh, only : mesh_type
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_newton_workspace, only : add_line
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_newton_step, only : find_step
   use lopin_line_search, only : search_type, take_step
   use lopin_predictor, only : iterate_type
   use lopin_semismooth_newton, only : solve_newton
   use lopin_held_tools, only : start_motion
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: pseudo_transient, set_metric

   !> Linear systems that a whole motion may take, and one of a part whose mesh can be made anew.
   !> The first of an increment that may be cut: of ten that come to rest nine do so in fewer, and
   !> shorter increments often need none. Each that fails lets the next take twice as many.
   integer, parameter :: most_systems = 600, most_of_part = 100, most_of_first = 100
   !> Steps of Newton of one implicit step, and how far they bring its residual down.
   integer, parameter :: most_of_step = 12, few = 4
   real(wp), parameter :: enough = 1.0e-2_wp
   !> Pseudo-time of the first step; what it grows and shrinks by; where it is given up: steps
   !> without end, or so long that the drag is rounding beside the elastic stiffness.
   real(wp), parameter :: first_time = 1.0_wp, fast = 3.0_wp, slow = 1.5_wp, back = 0.25_wp, &
      & least_time = 1.0e-8_wp, most_time = 1.0e12_wp
   !> Newton is tried again when the residual at rest has fallen by so much.
   real(wp), parameter :: fallen = 0.1_wp
   !> A motion that comes back to where it was a step before the last, but for this share of a step,
   !> and that so often in a row, hops to and fro: a flow that loses energy never comes back.
   real(wp), parameter :: same_place = 0.1_wp
   integer, parameter :: most_returns = 2

   !> A motion on its way.
   type :: transient_type
      real(wp) :: time = first_time            !! pseudo-time of the next step
      type(iterate_type) :: at
      real(wp), allocatable :: kept(:)         !! `v` to come back to
      real(wp), allocatable :: multiplier(:)   !! of the contact there
      type(evaluation_type) :: evaluation
      integer :: used = 0                      !! linear systems of the last step
      logical :: done = .false.                !! it was solved
      real(wp), allocatable :: last(:), before(:)   !! `v` where the last two steps ended
      integer :: returns = 0                   !! last steps that led back to the place before
   end type transient_type

contains

   !> The elastic stiffness of the accepted shape, and a share of mass.
   subroutine set_metric(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(mesh_type) :: moved
      real(wp) :: mass, size_
      integer :: i

      moved = model%mesh
      do i = 1, scene%dofs%n
         if (scene%dofs%dof(i) <= model%mesh%ndim) moved%x(scene%dofs%dof(i), scene%dofs%node(i)) &
            & = model%mesh%x(scene%dofs%dof(i), scene%dofs%node(i)) &
            & + scene%accepted%motion%u(i)
      end do
      associate (damping => scene%newton%damping)
         damping%metric = scene%k
         call assemble_stiffness(scene%solids, moved, damping%metric, error)
         if (allocated(error)) return
         size_ = scene%bodies%length
         if (scene%newton%contact%n > 0) size_ = maxval(scene%newton%contact%size)
         mass = scene%newton%reference/(size_*max(1, scene%dofs%n))
         do i = 1, damping%metric%n
            associate (at => damping%metric%slot(i, i))
               ! A rotation moves what lies a length of the scene away.
               damping%metric%value(at) = damping%metric%value(at) + merge(mass, &
                  & mass*scene%bodies%length**2, scene%dofs%dof(i) <= 3)
            end associate
         end do
      end associate
   end subroutine set_metric

   !> From the accepted state, where an increment has started, to an equilibrium at the
   !> prescribed values: implicit steps, with Newton tried whenever the residual has fallen.
   subroutine pseudo_transient(scene, model, f, iterate, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      type(iterate_type), intent(inout) :: iterate
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      type(transient_type) :: motion
      real(wp) :: tried
      integer :: systems, most
      logical :: rests

      call set_metric(scene, model, error)
      if (allocated(error)) return
      motion%at = iterate
      tried = huge(1.0_wp)
      systems = 0
      most = merge(most_of_part, most_systems, model%start%step > 0)
      if (scene%may_cut) most = min(most, &
         & most_of_first*2**min(scene%accepted%clock%vain_motions, 8))
      do while (systems < most .and. motion%time > least_time &
         & .and. motion%time < most_time)
         call keep_place(motion, scene)
         call implicit_step(motion, scene, model, f, prescribed, error)
         if (allocated(error)) return
         systems = systems + motion%used
         if (.not. motion%done) then
            call go_back(motion, scene)
            motion%time = back*motion%time
            cycle
         end if
         motion%at%before = prescribed
         call note_return(motion)
         if (motion%returns >= most_returns) exit
         motion%time = motion%time*merge(fast, slow, motion%used <= few)
         call look_at_rest(motion, scene, model, f, systems, error)
         if (allocated(error)) return
         if (motion%evaluation%merit > fallen*tried) cycle
         tried = motion%evaluation%merit
         call try_newton(motion, scene, model, f, prescribed, rests, error)
         if (allocated(error)) return
         if (.not. rests) cycle
         iterate%v = motion%at%v
         iterate%before = prescribed
         return
      end do
      call raise(error, error_code%not_converged, 'E0510', 'slow motion has come to no rest in '// &
         & to_text(systems)//' linear systems', model%step(scene%step)%at)
   end subroutine pseudo_transient

   !> Whether the step has led back to where the one before it began.
   pure subroutine note_return(self)
      type(transient_type), intent(inout) :: self
      logical :: returned

      returned = allocated(self%before)
      if (returned) returned = norm2(self%at%v - self%before) < same_place*norm2(self%at%v &
         & - self%last)
      self%returns = merge(self%returns + 1, 0, returned)
      if (allocated(self%last)) call move_alloc(self%last, self%before)
      self%last = self%at%v
   end subroutine note_return

   !> Newton from here, without the drag; back here if it fails.
   subroutine try_newton(self, scene, model, f, prescribed, rests, error)
      type(transient_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      logical, intent(out) :: rests            !! an equilibrium is reached
      type(error_type), allocatable, intent(out) :: error

      call keep_place(self, scene)
      call solve_newton(scene, model, f, self%at, prescribed, 0, error)
      rests = .not. allocated(error)
      if (rests) return
      if (error%code /= error_code%not_converged) return
      deallocate (error)
      call go_back(self, scene)
   end subroutine try_newton

   subroutine keep_place(self, scene)
      type(transient_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene

      self%kept = self%at%v
      self%multiplier = scene%trial%contact%multiplier
   end subroutine keep_place

   subroutine go_back(self, scene)
      type(transient_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene

      self%at%v = self%kept
      scene%trial%contact%multiplier = self%multiplier
      call expand(scene%constraints, self%at%v, self%at%before, scene%trial%motion%u)
   end subroutine go_back

   !> r(x) + D (x - x0)/time = 0 from the present state x0, with exact contact.
   subroutine implicit_step(self, scene, model, f, prescribed, error)
      type(transient_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(out) :: error
      type(search_type) :: search
      real(wp), allocatable :: remaining(:)
      real(wp) :: start, merits(2)

      scene%newton%damping%on = .true.
      ! What moves on its way slides as it may.
      call start_motion(scene%newton%contact)
      scene%newton%damping%rate = 1.0_wp/self%time
      scene%newton%damping%from = scene%trial%motion%u
      allocate (remaining(scene%dofs%n), source=0.0_wp)
      call expand(scene%constraints, 0.0_wp*self%at%v, prescribed - self%at%before, remaining)
      search%load = f
      search%prescribed = prescribed
      self%done = .false.
      self%evaluation%tangent = .false.
      start = 0.0_wp
      merits = 0.0_wp
      self%used = 0
      do while (self%used < most_of_step)
         call answer_interrupt(error)
         if (allocated(error)) return
         if (.not. self%evaluation%tangent) call evaluate(scene, model, f, .true., &
            & self%evaluation, error)
         if (allocated(error)) return
         if (self%evaluation%inverted > 0) return
         search%first = any(abs(remaining) > 0.0_wp)
         if (.not. search%first) start = max(start, self%evaluation%merit)
         self%done = self%used > 0 .and. .not. search%first .and. self%evaluation%merit <= &
            & enough*start
         if (self%done) return
         merits(1 + mod(self%used, 2)) = self%evaluation%merit
         self%used = self%used + 1
         search%merit = maxval(merits)
         call find_step(scene, model, self%evaluation, remaining, search%step, error, &
            & flat=.false., by_old=.false.)
         if (.not. allocated(error)) call take_step(scene, model, search, self%at%v, &
            & self%evaluation, error)
         if (allocated(error)) then
            if (error%code == error_code%not_converged) deallocate (error)
            return
         end if
         remaining = 0.0_wp
      end do
      self%done = self%evaluation%merit <= enough*start
   end subroutine implicit_step

   !> What is out of balance without the drag, for Newton and as a line of the log.
   subroutine look_at_rest(self, scene, model, f, systems, error)
      type(transient_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      integer, intent(in) :: systems           !! linear systems so far
      type(error_type), allocatable, intent(out) :: error
      character(len=100) :: text

      scene%newton%damping%on = .false.
      call evaluate(scene, model, f, .false., self%evaluation, error)
      if (allocated(error)) return
      write (text, '(a,i4,2(a,es10.2))') '  slow motion: systems', systems, ', next pseudo-time', &
         & self%time, ', residual at rest', self%evaluation%merit/max(self%evaluation%force, &
         & tiny(1.0_wp))
      call add_line(scene%newton, text)
   end subroutine look_at_rest
end module lopin_pseudo_transient
