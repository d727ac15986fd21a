!> Friction completed and checked against the whole model: LAW=AUTO chosen, materials and times that
!> a law needs.
module lopin_settle_friction
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, severity
   use lopin_text, only : to_text
   use lopin_friction, only : friction_type, law_of, law_names, automatic_law, reads_yield, &
      & depends_on_time
   use lopin_flow_curve, only : is_viscous
   use lopin_model, only : model_type
   use lopin_surface_material, only : pair_materials
   use lopin_block, only : complain
   use lopin_build_friction, only : missing
   implicit none
   private
   public :: settle_friction

contains

   !> All laws of all pairs.
   subroutine settle_friction(model)
      type(model_type), intent(inout) :: model
      type(friction_type) :: friction
      integer :: i, k, s

      do i = 1, size(model%interaction)
         friction = model%interaction(i)%friction
         call settle(model, i, friction)
         model%interaction(i)%friction = friction
      end do
      do s = 1, size(model%step)
         do k = 1, size(model%step(s)%friction_change)
            friction = model%step(s)%friction_change(k)%friction
            call settle(model, model%step(s)%friction_change(k)%interaction, friction)
            model%step(s)%friction_change(k)%friction = friction
         end do
      end do
   end subroutine settle_friction

   subroutine settle(model, interaction, friction)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: interaction
      type(friction_type), intent(inout) :: friction
      logical :: used(size(model%material)), own(size(model%material))
      integer :: i

      used = .false.
      do i = 1, size(model%pair)
         if (model%pair(i)%interaction /= interaction) cycle
         call pair_materials(model, i, own)
         used = used .or. own
      end do
      if (friction%law == law_of%automatic) call choose(model, interaction, friction, used)
      if (.not. any(used)) return
      if (reads_yield(friction)) then
         call check_yield(model, interaction, friction, used)
      end if
      if (depends_on_time(friction)) call check_time(model, interaction, friction)
   end subroutine settle

   !> Lecture E, remarks 2 to 6: the law that goes with the material.
   subroutine choose(model, interaction, friction, used)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: interaction
      type(friction_type), intent(inout) :: friction
      logical, intent(in) :: used(:)
      integer :: k, law, first
      character(len=:), allocatable :: why

      friction%law = law_of%coulomb
      first = 0
      why = 'no pair uses it'
      do k = 1, size(used)
         if (.not. used(k)) cycle
         call automatic_law(model%material(k)%yield > 0.0_wp, model%material(k)%hardens, &
            & is_viscous(model%material(k)%flow), law, why)
         why = 'material `'//model%material(k)%name//'` is '//why
         if (first > 0 .and. law /= friction%law) then
            call complain(model%log, 'E0322', 'LAW=AUTO finds '//trim(law_names(friction%law))// &
               & ' for material `'//model%material(first)%name//'` and '//trim(law_names(law))// &
               & ' for `'//model%material(k)%name//'`', friction%at, help='write LAW=, or give '// &
               & 'each pair its own interaction')
            return
         end if
         friction%law = law
         first = k
      end do
      if (friction%mu > 0.0_wp .and. friction%law /= law_of%coulomb) then
         friction%rise = min(friction%mu, friction%rise)
         why = why//'; below '//to_text(friction%rise)//' p'
      end if
      call model%log%say(severity%note, 'N0321', 'LAW=AUTO of interaction `'// &
         & model%interaction(interaction)%name//'` is '//trim(law_names(friction%law))//': '//why, &
         & friction%at)
      call take_what_it_needs(model, friction)
   end subroutine choose

   !> The data of LAW=AUTO that the chosen law reads must be there; the others are put back to 0.
   subroutine take_what_it_needs(model, friction)
      type(model_type), intent(inout) :: model
      type(friction_type), intent(inout) :: friction
      character(len=:), allocatable :: lacks

      lacks = ''
      select case (friction%law)
      case (law_of%coulomb)
         if (friction%mu <= missing) lacks = 'mu (the first datum)'
      case (law_of%norton_hoff)
         if (friction%alpha <= missing) lacks = 'alpha and q (the third and fourth datum)'
      case default
         if (friction%m <= missing) lacks = 'm (the second datum)'
      end select
      if (len(lacks) > 0) call complain(model%log, 'E0103', 'LAW=AUTO chose '// &
         & trim(law_names(friction%law))//', which needs '//lacks, friction%at)
      if (friction%mu <= missing) friction%mu = 0.0_wp
      if (friction%m <= missing) friction%m = 0.0_wp
      if (friction%alpha <= missing) friction%alpha = 0.0_wp
      if (friction%law == law_of%coulomb .and. .not. friction%mu > 0.0_wp) &
         & friction%law = law_of%none
   end subroutine take_what_it_needs

   !> Tresca and Orowan need a yield stress or TAUMAX; Cristescu is only capped by it.
   subroutine check_yield(model, interaction, friction, used)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: interaction
      type(friction_type), intent(in) :: friction
      logical, intent(in) :: used(:)
      integer :: k

      if (friction%law == law_of%cristescu .or. friction%tau_max < huge(1.0_wp)) return
      do k = 1, size(used)
         if (.not. used(k) .or. model%material(k)%yield > 0.0_wp) cycle
         call complain(model%log, 'E0322', 'the friction '//trim(law_names(friction%law))// &
            & ' of interaction `'//model%interaction(interaction)%name// &
            & '` needs a yield stress, which material `'//model%material(k)%name// &
            & '` of the slave has not', friction%at, &
            & help='add *PLASTIC to the material, or TAUMAX= to *FRICTION')
      end do
   end subroutine check_yield

   !> A speed of slip needs a real time: the default period of 1 is one by chance.
   subroutine check_time(model, interaction, friction)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: interaction
      type(friction_type), intent(in) :: friction
      integer :: s

      do s = 1, size(model%step)
         if (model%step(s)%timed) cycle
         call model%log%say(severity%warning, 'W0322', 'the friction of interaction `'// &
            & model%interaction(interaction)%name//'` depends on the speed of slip, and step '// &
            & to_text(s)//' has no period: it is 1 by default', friction%at, &
            & help='write the times after *STATIC: initial, period')
         return
      end do
   end subroutine check_time
end module lopin_settle_friction
