!> Estimate of the pressure error by penetration on the nonlinear path, from the tangent; and slopes
!> that follow from it.
module lopin_compliance_error
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_constraints, only : expand
   use lopin_model, only : model_type
   use lopin_soft_share, only : largest_share
   use lopin_nonlinear_contact, only : set_slopes
   use lopin_newton_system, only : solve_step
   use lopin_predictor, only : iterate_type
   use lopin_semismooth_newton, only : solve_newton
   use lopin_raise_penalty, only : raising_type, chooses_slope, choose_other, report_raised
   use lopin_state, only : judged_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: limit_compliance

   !> Of GMRES: the estimate is good to a few per cent anyway.
   real(wp), parameter :: tolerance = 1.0e-2_wp
   !> An estimate holds for so many increments, and below this share of the target error where it
   !> decides on slopes.
   integer, parameter :: most_increments = 10
   real(wp), parameter :: well_below = 0.25_wp

contains

   !> Estimate the error of the pressures of an equilibrium; where slopes that were chosen are too
   !> soft for it, find it again by stiffer ones.
   subroutine limit_compliance(scene, model, f, iterate, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      type(iterate_type), intent(inout) :: iterate
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      type(raising_type) :: raising
      real(wp), allocatable :: v_then(:), multiplier(:)
      real(wp) :: share
      logical :: chooses, augments, again

      if (scene%newton%iterations == 0) return
      associate (state => scene%trial%contact)
         state%softness = 0.0_wp
         if (.not. any(is_too_compliant(scene))) return
         call chooses_slope(model, chooses, augments)
         if (still_holds(scene, model, chooses)) then
            state%softness = scene%accepted%contact%softness
            return
         end if
         call estimate(scene, model, share)
         state%softness = share
         if (.not. chooses) return
         iterate%before = prescribed
         iterate%guessed = .false.
         do
            call choose_other(raising, state, .not. allocated(error), share, model%target_error, &
               & again)
            if (.not. again) exit
            call set_slopes(scene%newton%contact, state%stiffer)
            if (raising%before > 0.0_wp) then
               v_then = iterate%v
               multiplier = state%multiplier
            else
               iterate%v = v_then
               state%multiplier = multiplier
               call expand(scene%constraints, iterate%v, prescribed, scene%trial%motion%u)
            end if
            if (allocated(error)) deallocate (error)
            call solve_newton(scene, model, f, iterate, prescribed, 1, error)
            if (.not. allocated(error)) then
               call estimate(scene, model, share)
            else if (.not. raising%before > 0.0_wp) then
               return
            end if
         end do
         if (.not. allocated(error)) call report_raised(raising, scene, model)
      end associate
   end subroutine limit_compliance

   !> The estimate of an increment before still holds: the same points are closed, and no pair
   !> presses less than before, for solids that flow are stiff again when they unload.
   logical function still_holds(scene, model, chooses) result(holds)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: chooses           !! some slopes may be raised
      logical :: closed(scene%newton%contact%n)
      real(wp) :: pressed(size(model%pair))
      integer :: i

      pressed = 0.0_wp
      associate (c => scene%newton%contact, last => scene%accepted%contact%judged)
         closed = c%status(:c%n) > 0
         do i = 1, c%n
            if (closed(i)) pressed(c%pair(i)) = pressed(c%pair(i)) + c%weight(i)*c%pressure(i)
         end do
         holds = allocated(last%closed) .and. last%before < most_increments &
            & .and. scene%newton%time < model%step(scene%step)%period
         if (holds) holds = size(last%closed) == c%n .and. size(last%pressed) == size(pressed)
         if (holds) holds = all(last%closed .eqv. closed) .and. all(pressed >= last%pressed)
         if (holds .and. chooses) holds = scene%accepted%contact%softness &
            & <= well_below*model%target_error
         scene%trial%contact%judged = judged_type(closed, merge(last%before + 1, 0, holds), pressed)
      end associate
   end function still_holds

   !> Points whose traction is an unknown, and which penetrate in proportion to it.
   function is_too_compliant(scene) result(soft)
      type(scene_type), intent(in) :: scene
      logical :: soft(scene%newton%contact%n)
      integer :: i

      associate (c => scene%newton%contact)
         soft = [(.not. c%enforcement(i)%method%is_exact() .and. c%status(i) > 0 &
            & .and. c%first_row(i) > 0, i=1, c%n)]
      end associate
   end function is_too_compliant

   !> What one augmentation changes, by the tangent at hand: of every mode of the pressures
   !> 1/(1 + slope*compliance), the share that penetration takes away.
   subroutine estimate(scene, model, share)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: share           !! of the forces of a pair, largest
      type(error_type), allocatable :: error
      real(wp), allocatable :: right(:), step(:), change(:), force(:)
      logical :: soft(scene%newton%contact%n)
      integer :: i, k, d, pair, bad, krylov, most

      share = 0.0_wp
      d = model%mesh%ndim
      associate (c => scene%newton%contact, system => scene%newton%system, &
         & neq => scene%constraints%neq)
         soft = is_too_compliant(scene)
         if (.not. any(soft)) return
         allocate (right(neq + c%nmultiplier), step(neq + c%nmultiplier), source=0.0_wp)
         do i = 1, c%n
            if (.not. soft(i)) cycle
            k = neq + c%first_row(i)
            right(k:k + d - 1) = c%pressure(i)/c%enforcement(i)%slope*c%normal(:d, i)
         end do
         krylov = system%krylov%last
         most = system%krylov%most
         call solve_step(system, right, tolerance, step, scene%clock, &
            & scene%counter, bad, error)
         system%krylov%last = krylov
         system%krylov%most = most
         share = 1.0_wp
         if (allocated(error) .or. bad > 0) return
         allocate (change(size(model%pair)), force(size(model%pair)), source=0.0_wp)
         do i = 1, c%n
            if (c%status(i) == 0 .or. c%first_row(i) == 0) cycle
            if (c%enforcement(i)%tied) cycle
            k = neq + c%first_row(i)
            pair = c%pair(i)
            force(pair) = force(pair) + c%weight(i)*c%pressure(i)
            ! What presses is the unknown less c times its row, which holds the right-hand side.
            change(pair) = change(pair) + c%weight(i)*dot_product(step(k:k + d - 1) &
               & - c%c(i)*right(k:k + d - 1), c%normal(:d, i))
         end do
         ! What one facet alone is too soft for, each point's own estimate says.
         share = largest_share(change, force, [(i, i=1, size(model%pair) + 1)])
      end associate
   end subroutine estimate
end module lopin_compliance_error
