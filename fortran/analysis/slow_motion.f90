!> Where Newton finds no way to the next equilibrium: an implicit motion through pseudo-time.
!>
!> A path of equilibria may turn back where a node leaves a tool: the states beyond are far from the
!> last one however small the increment is. A real part jumps there. The motion D dx/dt = -r, taken
!> by implicit steps from the accepted state, follows such a jump, and Newton ends it: what is
!> accepted is an equilibrium like any other (pseudo-transient continuation, Kelley and Keyes, SIAM
!> J. Numer. Anal. 35, 1998, 508-523). D is the elastic stiffness of the accepted shape, so that
!> long waves move as fast as short ones, and pseudo-time is a number without a unit. A share of
!> mass is added, which lets a free body move by a facet in unit time under the forces about.
module lopin_slow_motion
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_mesh, only : mesh_type
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_assemble_solids, only : assemble_stiffness
   use lopin_finite_history, only : start_increment
   use lopin_finite_release, only : release_finite_ties
   use lopin_finite_state, only : add_line, is_nonlinear
   use lopin_finite_forces, only : look_type, look_at
   use lopin_newton_step, only : find_step
   use lopin_line_search, only : way_type, take_step
   use lopin_finite_newton, only : newton
   use lopin_predict, only : start_from_accepted
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: move_slowly

   !> Linear systems that a whole motion may take; steps of Newton of one implicit step, and how far
   !> they bring its residual down.
   integer, parameter :: most_systems = 600, most_of_step = 12, few = 4
   real(wp), parameter :: enough = 1.0e-2_wp
   !> Pseudo-time of the first step; what it grows and shrinks by; where it is given up.
   real(wp), parameter :: first_time = 1.0_wp, fast = 3.0_wp, slow = 1.5_wp, back = 0.25_wp, &
      & least_time = 1.0e-8_wp
   !> Newton is tried again when the residual at rest has fallen by so much.
   real(wp), parameter :: fallen = 0.1_wp

   !> A motion on its way.
   type :: motion_type
      real(wp) :: time = first_time            !! pseudo-time of the next step
      real(wp), allocatable :: v(:)            !! (neq) free displacements [length]
      real(wp), allocatable :: reached(:)      !! (nprescribed) values that go with them
      type(look_type) :: look
      integer :: used = 0                      !! linear systems of the last step
      logical :: done = .false.                !! it was solved
   end type motion_type

contains

   !> From the accepted state to the equilibrium at the prescribed values, where Newton alone has
   !> failed; the error of Newton stays if this fails too.
   subroutine move_slowly(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failed

      if (error%code /= error_code%not_converged .or. .not. is_nonlinear(scene%finite)) return
      call add_line(scene%finite, '  slow motion from the accepted state')
      call set_metric(scene, model, failed)
      if (allocated(failed)) return
      call follow(scene, model, f, prescribed, failed)
      scene%finite%drag%on = .false.
      if (allocated(failed)) then
         if (failed%code /= error_code%not_converged) call move_alloc(failed, error)
         return
      end if
      scene%finite%jumped = .true.
      scene%finite%parted = .true.
      deallocate (error)
   end subroutine move_slowly

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
      associate (drag => scene%finite%drag)
         drag%metric = scene%k
         call assemble_stiffness(scene%solids, moved, drag%metric, error)
         if (allocated(error)) return
         size_ = scene%bodies%length
         if (scene%finite%contact%n > 0) size_ = maxval(scene%finite%contact%size)
         mass = scene%finite%reference/(size_*max(1, scene%dofs%n))
         do i = 1, drag%metric%n
            associate (at => drag%metric%colptr(i))
               if (drag%metric%row(at) == i) drag%metric%value(at) = drag%metric%value(at) + mass
            end associate
         end do
         drag%from = scene%accepted%motion%u
      end associate
   end subroutine set_metric

   !> Implicit steps, with Newton tried whenever the residual has fallen.
   subroutine follow(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(out) :: error
      type(motion_type) :: motion
      real(wp), allocatable :: v(:), multiplier(:)
      real(wp) :: tried, rest
      integer :: systems

      scene%trial%contact%multiplier = scene%accepted%contact%multiplier
      call start_from_accepted(scene, motion%v, motion%reached)
      call start_increment(scene%finite%contact, model, scene%accepted%contact, &
         & scene%accepted%motion%u, scene%finite%dt, error)
      if (allocated(error)) return
      call release_finite_ties(scene%finite%contact, model, scene%constraints)
      tried = huge(1.0_wp)
      systems = 0
      do while (systems < most_systems .and. motion%time > least_time)
         call keep_place()
         call implicit_step(motion, scene, model, f, prescribed, error)
         if (allocated(error)) return
         systems = systems + motion%used
         if (.not. motion%done) then
            call go_back()
            motion%time = back*motion%time
            cycle
         end if
         motion%reached = prescribed
         motion%time = motion%time*merge(fast, slow, motion%used <= few)
         scene%finite%drag%on = .false.
         call look_at(scene, model, f, .false., motion%look, error)
         if (allocated(error)) return
         rest = motion%look%merit
         call say_step(scene, systems, motion%time, rest/max(motion%look%force, tiny(1.0_wp)))
         if (rest > fallen*tried) cycle
         tried = rest
         call keep_place()
         call newton(scene, model, f, motion%v, motion%reached, prescribed, 0, .false., error)
         if (.not. allocated(error)) return
         if (error%code /= error_code%not_converged) return
         deallocate (error)
         call go_back()
      end do
      call raise(error, error_code%not_converged, 'E0510', 'slow motion has come to no rest in '// &
         & to_text(systems)//' linear systems', model%step(scene%step)%at)

   contains

      subroutine keep_place()
         v = motion%v
         multiplier = scene%trial%contact%multiplier
      end subroutine keep_place

      subroutine go_back()
         motion%v = v
         scene%trial%contact%multiplier = multiplier
         call expand(scene%constraints, motion%v, motion%reached, scene%trial%motion%u)
      end subroutine go_back
   end subroutine follow

   !> r(x) + D (x - x0)/time = 0 from the present state x0, with exact contact.
   subroutine implicit_step(self, scene, model, f, prescribed, error)
      type(motion_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(out) :: error
      type(way_type) :: way
      real(wp), allocatable :: jump(:)
      real(wp) :: start, merits(2)

      scene%finite%drag%on = .true.
      scene%finite%drag%rate = 1.0_wp/self%time
      scene%finite%drag%from = scene%trial%motion%u
      allocate (jump(scene%dofs%n), source=0.0_wp)
      call expand(scene%constraints, 0.0_wp*self%v, prescribed - self%reached, jump)
      way%load = f
      way%prescribed = prescribed
      self%done = .false.
      self%look%tangent = .false.
      start = 0.0_wp
      merits = 0.0_wp
      self%used = 0
      do while (self%used < most_of_step)
         if (.not. self%look%tangent) call look_at(scene, model, f, .true., self%look, error)
         if (allocated(error)) return
         if (self%look%inverted > 0) return
         way%first = any(abs(jump) > 0.0_wp)
         if (.not. way%first) start = max(start, self%look%merit)
         self%done = self%used > 0 .and. .not. way%first .and. self%look%merit <= enough*start
         if (self%done) return
         merits(1 + mod(self%used, 2)) = self%look%merit
         self%used = self%used + 1
         way%merit = maxval(merits)
         call find_step(scene, model, self%look, jump, way%step, error, flat=.false., &
            & by_old=.false.)
         if (.not. allocated(error)) call take_step(scene, model, way, self%v, self%look, error)
         if (allocated(error)) then
            if (error%code == error_code%not_converged) deallocate (error)
            return
         end if
         jump = 0.0_wp
      end do
      self%done = self%look%merit <= enough*start
   end subroutine implicit_step

   !> One line of the log.
   subroutine say_step(scene, systems, time, residual)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: systems
      real(wp), intent(in) :: time, residual
      character(len=100) :: text

      write (text, '(a,i4,2(a,es10.2))') '  slow motion: systems', systems, ', next pseudo-time', &
         & time, ', residual at rest', residual
      call add_line(scene%finite, text)
   end subroutine say_step
end module lopin_slow_motion
