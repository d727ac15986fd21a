!> How far bodies have approached for nothing, where the facets of a slave are long beside what a
!> meshed master does within them.
!>
!> At the nodes of a slave that is the coarser side, nodes of the master between them have no force
!> and sink in, all over the contact. Surface to surface a facet meets a curved master in the mean,
!> here inside and there before it. By as much, in the mean by the forces of the nodes, the way of
!> the bodies is unknown; of a force that grows with its way in proportion, F = 2 W/way, so much is
!> lost, or unknown.
module lopin_lost_approach
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_facets, only : facets_type
   use lopin_model, only : model_type
   use lopin_mortar_pairs, only : is_mortar
   use lopin_scene, only : scene_type
   use lopin_master_entries, only : entry_type
   use lopin_touched_width, only : find_closed, leave_narrow
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_lost_approach, deepest_contact

   !> Force that is lost or unknown, beside the force, that is told.
   real(wp), parameter :: told = 0.03_wp
   !> What is off surface to surface by the room inside and before the facets: .1 to 1.1 of it was
   !> measured, .4 in the middle.
   real(wp), parameter :: of_room = 0.5_wp

contains

   subroutine check_lost_approach(scene, model, pair, facets, entry, work)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(facets_type), intent(in) :: facets
      type(entry_type), intent(in) :: entry(:)   !! (facets)
      real(wp), intent(in) :: work             !! stored and spent in the bodies [energy]
      real(wp) :: force(model%mesh%nnode), lost
      logical :: narrow(size(force))
      integer :: depth

      ! A smoothed master is where its facets are not.
      if (.not. work > 0.0_wp .or. model%pair(pair)%smooth) return
      force = forces_of(scene, size(force), pair)
      associate (p => model%pair(pair), slave => model%surface(model%pair(pair)%slave)%name, &
         & master => model%surface(model%pair(pair)%master)%name)
         if (is_mortar(model, p)) then
            ! Wide contact is right in the mean, whatever the room.
            call find_closed(scene, pair, narrow)
            call leave_narrow(facets, narrow, depth)
            where (.not. narrow) force = 0.0_wp
            lost = of_room*work_over(facets, entry, entry%inside + entry%before, force) &
               & /(2.0_wp*work)
            if (lost > told) call warn_once(scene%log, 'W0349', master// &
               & ' is curved within the facets of '//slave//', which meet it in the mean: '// &
               & 'forces of given ways may be off by about '//to_text(100.0_wp*lost, 2)//' %', &
               & p%at, help='facets half as long on '//slave//'; or exchange slave and master')
         else
            lost = work_over(facets, entry, entry%inside, force)/(2.0_wp*work)
            if (lost > told) call warn_once(scene%log, 'W0340', master//' sinks into '//slave// &
               & ' between its nodes: forces of given ways are too low by about '// &
               & to_text(100.0_wp*lost, 2)//' %', p%at, &
               & help='TYPE=SURFACE TO SURFACE; or the side with the shorter facets as slave')
         end if
      end associate
   end subroutine check_lost_approach

   !> Forces of the nodes over the mean room of the facets about each [energy].
   pure real(wp) function work_over(f, entry, room, force) result(work)
      type(facets_type), intent(in) :: f
      type(entry_type), intent(in) :: entry(:)
      real(wp), intent(in) :: room(:)          !! (facets) [length^ndim]
      real(wp), intent(in) :: force(:)         !! (nnode)
      real(wp) :: volume(size(force)), area(size(force))
      integer :: i

      volume = 0.0_wp
      area = 0.0_wp
      do i = 1, f%n
         associate (node => f%node(:f%nnode(i), i))
            volume(node) = volume(node) + room(i)
            area(node) = area(node) + entry(i)%area
         end associate
      end do
      work = 0.0_wp
      do i = 1, size(force)
         if (area(i) > 0.0_wp) work = work + force(i)*volume(i)/area(i)
      end do
   end function work_over

   !> Forces by which the nodes of a pair's slave press.
   pure function forces_of(scene, nnode, pair) result(force)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: nnode, pair
      real(wp) :: force(nnode)
      integer :: i

      force = 0.0_wp
      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            do i = 1, c%n
               if (c%pair(i) == pair .and. c%status(i) > 0) force(c%node(i)) = &
                  & force(c%node(i)) + c%pressure(i)*c%weight(i)
            end do
         end associate
         return
      end if
      do i = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
         associate (node => scene%points%node(scene%rows%point(i)))
            force(node) = force(node) + max(0.0_wp, scene%answer%force(i))
         end associate
      end do
   end function forces_of

   !> Deeper is no contact of a pair [length].
   pure real(wp) function deepest_contact(scene, pair) result(depth)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: pair

      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            depth = minval(c%depth(:c%n), mask=c%pair(:c%n) == pair)
         end associate
      else
         depth = minval(scene%points%depth(:scene%points%n), &
            & mask=scene%points%pair(:scene%points%n) == pair)
      end if
   end function deepest_contact
end module lopin_lost_approach
