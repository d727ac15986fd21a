!> What to try where an increment fails, by what the scene shows: whoever lets increments be cut is
!> not told to take smaller ones.
module lopin_failure_advice
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_slip_increment, only : lost_bound
   use lopin_free_body, only : pushed_by_forces
   use lopin_edge_advice, only : exchange_at_edges
   use lopin_scene, only : scene_type
   use lopin_run_type, only : run_type
   implicit none
   private
   public :: advise

   !> How the remedies begin that this module replaces.
   character(len=*), parameter :: too_large = 'smaller increments'
   !> Of a tangent that is singular.
   character(len=*), parameter :: singular_id = 'E0511'

contains

   !> How far the step came, and what to try, into an error that ends the run.
   subroutine advise(run, model, error)
      class(run_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(error_type), intent(inout) :: error
      character(len=:), allocatable :: help
      logical :: singular

      if (error%code /= error_code%not_converged) return
      associate (item => error%item(1), step => model%step(run%scene%step), &
         & clock => run%scene%accepted%clock, frame => run%frame)
         if (.not. allocated(item%help)) return
         singular = item%id == singular_id
         if (.not. (singular .or. index(item%help, too_large) == 1)) return
         if (.not. allocated(item%note)) item%note = ''
         if (len(item%note) == 0) item%note = 'step '//to_text(run%scene%step)// &
            & ' has come to time '//to_text(clock%time, 6)//' of '//to_text(step%period, 6)// &
            & '; the increment from there is '//to_text(frame%time_increment, 3)// &
            & cuts_of(frame%attempt)
         if (singular) then
            help = remedies(run, model)
            call add(help, 'hold the part that is free to move, or give it a mesh and a flow '// &
               & 'curve that bear the strain')
         else if (step%direct) then
            help = 'leave DIRECT out of *STATIC (an increment that fails is then cut), or take '// &
               & item%help
         else
            help = ''
            if (frame%time_increment > 1.0e-4_wp*step%period .and. step%smallest > 0.0_wp) &
               & help = 'let increments be cut further: the third number of *STATIC, '// &
               & to_text(step%smallest, 3)//', forbids it'
            if (run%scene%newton%in_use) call add(help, exchange_at_edges(run%scene, model))
            call add(help, alternative_in(item%help))
            call add(help, remedies(run, model))
            if (len(help) == 0) help = 'look at that place in the last increment that was '// &
               & 'found: supports that contradict each other, or a mesh too coarse for its radius'
         end if
         item%help = help
      end associate
   end subroutine advise

   pure function cuts_of(attempt) result(text)
      integer, intent(in) :: attempt
      character(len=:), allocatable :: text

      text = ''
      if (attempt > 1) text = ', cut '//to_text(attempt - 1)//' times'
      if (attempt == 2) text = ', cut once'
   end function cuts_of

   !> What the remedy offers beside smaller increments.
   pure function alternative_in(help) result(text)
      character(len=*), intent(in) :: help
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      i = index(help, ', ')
      if (i == 0) return
      text = help(i + 2:)
      if (index(text, 'or ') == 1) text = text(4:)
      if (index(text, 'and ') == 1) text = text(5:)
   end function alternative_in

   !> Every remedy whose cause is in the scene.
   function remedies(run, model) result(text)
      class(run_type), intent(in) :: run
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      character(len=:), allocatable :: soft

      text = ''
      associate (scene => run%scene, step => model%step(run%scene%step))
         if (pushed_by_forces(step)) then
            soft = without_hardening(model)
            if (len(soft) > 0) then
               call add(text, 'material '//soft//' does not harden, so there is a largest '// &
                  & 'load, and no equilibrium beyond it: drive by displacement (*BOUNDARY) and '// &
                  & 'read the force, or give *PLASTIC its hardening')
            else
               call add(text, 'forces drive this step, and beyond the largest one that the '// &
                  & 'part bears there is no equilibrium: drive by displacement (*BOUNDARY) '// &
                  & 'and read '// &
                  & 'the force, or look at the loads')
            end if
         end if
         call add(text, remedy_of_contact(scene, model))
      end associate
   end function remedies

   !> Of the pairs that are closed.
   function remedy_of_contact(scene, model) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      logical :: rubs, faceted, exact, holds, jams
      real(wp) :: lost, bound                  !! of shear [stress]
      integer :: i

      text = ''
      rubs = .false.
      holds = .false.
      jams = .false.
      faceted = .false.
      if (.not. scene%newton%in_use) return
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%status(i) <= 0) cycle
            associate (pair => model%pair(c%pair(i)))
               exact = model%interaction(pair%interaction)%method%is_exact()
               holds = holds .or. exact
               call lost_bound(c, i, lost, bound)
               jams = jams .or. c%pressure(i) > 0.0_wp .and. bound > c%pressure(i)
               rubs = rubs .or. exact .and. has_friction(c%friction(c%pair(i)))
               faceted = faceted .or. model%surface(pair%master)%tool == 0 .and. .not. &
                  & pair%smooth .and. .not. pair%surface_to_surface
            end associate
         end do
      end associate
      if (faceted) call add(text, 'SMOOTH=YES on *CONTACT PAIR, where nodes pass the edges of '// &
         & 'facets of the master')
      if (jams) call add(text, 'LAW=COULOMB-OROWAN, or LAW=AUTO with a coefficient, on '// &
         & '*FRICTION: the law allows more shear than there is pressure, as on a sheet that is '// &
         & 'pressed lightly')
      if (holds) call add(text, 'PENALTY on *SURFACE BEHAVIOR, where points jam that exact '// &
         & 'contact does not let give way')
      if (rubs) call add(text, 'ELASTIC SLIP= on *FRICTION, where points change between stick '// &
         & 'and slip')
   end function remedy_of_contact

   !> A metal that flows at one stress; '': none.
   pure function without_hardening(model) result(name)
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: name
      integer :: k

      name = ''
      do k = 1, size(model%section)
         associate (material => model%material(model%section(k)%material))
            if (material%yield > 0.0_wp .and. .not. material%hardens) name = material%name
         end associate
      end do
   end function without_hardening

   pure subroutine add(text, more)
      character(len=:), allocatable, intent(inout) :: text
      character(len=*), intent(in) :: more

      if (len(more) == 0) return
      if (len(text) > 0) then
         text = text//'; or '//more
      else
         text = more
      end if
   end subroutine add
end module lopin_failure_advice
