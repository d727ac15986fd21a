!> Changes of contact in a step: *CHANGE FRICTION and *MODEL CHANGE, TYPE=CONTACT PAIR.
module lopin_build_changes
   use lopin_error, only : location_type
   use lopin_text, only : upper
   use lopin_model, only : model_type, friction_change_type, pair_change_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, complain, &
      & has_parameter, line_place
   use lopin_build_friction, only : read_friction
   use lopin_build_scene, only : scene_type
   use lopin_build_behaviours, only : interaction_named
   use lopin_build_surfaces, only : surface_named
   implicit none
   private
   public :: build_changes, pair_named

contains

   subroutine build_changes(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer :: s

      do s = 1, size(model%step)
         allocate (model%step(s)%friction_change(0), model%step(s)%pair_change(0))
         call changes_of_step(model, deck, scene, s)
      end do
   end subroutine build_changes

   subroutine changes_of_step(model, deck, scene, s)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: s
      type(friction_change_type) :: change
      integer :: k
      logical :: waiting

      waiting = .false.
      do k = 1, scene%ncard
         if (scene%card(k)%step /= s) cycle
         associate (block => deck%block(scene%card(k)%block))
            select case (block%keyword)
            case ('CHANGE FRICTION')
               if (waiting) call without_friction(change%at)
               call open_change(change, block)
               waiting = .true.
            case ('FRICTION')
               waiting = .false.
               call read_friction(change%friction, block, model%log)
               if (change%interaction > 0) call keep(change)
            case ('MODEL CHANGE')
               call change_pairs(model, scene, block, scene%card(k)%scope, s)
            end select
         end associate
      end do
      if (waiting) call without_friction(change%at)
   contains
      subroutine without_friction(at)
         type(location_type), intent(in) :: at
         call complain(model%log, 'E0306', '*CHANGE FRICTION is not followed by *FRICTION', at)
      end subroutine without_friction

      subroutine open_change(change, block)
         type(friction_change_type), intent(out) :: change
         type(block_type), intent(in) :: block

         change%at = block%at
         change%interaction = interaction_named(model, block)
      end subroutine open_change

      !> For the interaction and for those that change its behaviour, which have its name.
      subroutine keep(change)
         type(friction_change_type), intent(in) :: change
         type(friction_change_type) :: same
         integer :: i

         same = change
         do i = change%interaction, size(model%interaction)
            if (model%interaction(i)%name /= model%interaction(change%interaction)%name) cycle
            same%interaction = i
            model%step(s)%friction_change = [model%step(s)%friction_change, same]
         end do
      end subroutine keep
   end subroutine changes_of_step

   subroutine change_pairs(model, scene, block, scope, s)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope, s
      type(pair_change_type) :: change
      type(field_type), allocatable :: field(:)
      integer :: j, n
      logical :: add

      add = has_parameter(block, 'ADD')
      if (add .eqv. has_parameter(block, 'REMOVE')) call complain(model%log, 'E0106', &
         & '*MODEL CHANGE needs one of ADD and REMOVE', block%at)
      if (block%nline == 0) call complain(model%log, 'E0304', '*MODEL CHANGE names no pair', &
         & block%at, help='a line with the slave surface and the master surface')
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         change%at = line_place(block%line(j))
         if (n < 2) n = 1
         change%active = add
         change%pair = pair_named(model, scene, field(1), field(n), scope, change%at)
         if (change%pair > 0) model%step(s)%pair_change = [model%step(s)%pair_change, change]
      end do
   end subroutine change_pairs

   !> The contact pair of two surfaces; 0, with a complaint, if there is none.
   integer function pair_named(model, scene, slave, master, scope, at) result(pair)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(field_type), intent(in) :: slave, master    !! names of the surfaces
      integer, intent(in) :: scope
      type(location_type), intent(in) :: at            !! of the complaint
      integer :: one, other

      pair = 0
      one = surface_named(model, scene, slave%text, scope, slave%at)
      other = surface_named(model, scene, master%text, scope, master%at)
      if (one == 0 .or. other == 0) return
      pair = findloc(model%pair%slave == one .and. model%pair%master == other, .true., dim=1)
      if (pair == 0) call complain(model%log, 'E0304', upper(slave%text)//', ' &
         & //upper(master%text)//' is no contact pair', at, &
         & help='slave, master, as in *CONTACT PAIR')
   end function pair_named
end module lopin_build_changes
